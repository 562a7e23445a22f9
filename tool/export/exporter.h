/// What stands between `softreel export` and a file format: a writer that is given samples one by one, and the record
/// by which a format says what it can hold.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/placement.h"
#include "core/mesh/surface_mesh.h"
#include "render/scene/camera.h"
#include "render/scene/material.h"
#include "tool/bodies/body_stage.h"
#include "tool/shot/shot.h"

namespace softreel {

enum class ExportSpace {
  Object,  ///< the mesh file's own axes, unit and origin
  World    ///< as placed in the scene
};

/// What was asked of an export, for all formats of one run.
struct ExportSettings {
  ExportSpace space = ExportSpace::Object;
  double meters_per_unit = 1;  ///< of the export's world
  UpAxis up = UpAxis::Y;       ///< of the export's world: Y or Z
  double fps = 24;             ///< frames a second at which it plays
  int subframes = 0;           ///< samples between two frames
  bool normals = false;
  double voxel = 0;  ///< edge of a voxel, in the unit of the positions; 0: the format's own choice
};

/// When the samples of one file are taken, in frames of the shot.
struct SampleTimes {
  double first = 1;
  int per_frame = 1;  ///< samples from one frame to the next
  int count = 1;

  double frame(int sample) const { return first + static_cast<double>(sample) / per_frame; }
};

/// The tetrahedra of a body at a sample, for formats that need them. Positions are in the scene, m.
struct TetSample {
  const FilledBody& filled;                       ///< rest nodes, tetrahedra, embedding of the surface
  const std::vector<ElementMaterial>& materials;  ///< per tetrahedron
  const std::vector<Vec3>& nodes;                 ///< deformed nodes
  Dilatation dilatation = Dilatation::Capped;     ///< of the solver
};

/// One body at one time. Spans are valid during the call only.
struct ExportSample {
  std::size_t body = 0;             ///< into ExportTarget::bodies
  double frame = 0;                 ///< SampleTimes::frame of the sample
  std::span<const Vec3> positions;  ///< one per vertex of the mesh file, in the space, unit and axes asked for
  std::span<const Vec3> normals;    ///< unit length, of the same; empty unless ExportSettings::normals
  const TetSample* tets = nullptr;  ///< null unless ExportFormat::needs_tets
};

/// What does not change from sample to sample.
struct ExportBody {
  std::string name;
  const SurfaceMesh* mesh = nullptr;  ///< of the file, in its own unit; `triangles` are the repaired ones
  std::string material;               ///< its name
  Appearance appearance;              ///< of it, at the first sample
  TextureSettings textures;           ///< of it
  Placement file_to_space;            ///< from mesh->positions to the coordinates of ExportSample::positions
  /// From the coordinates of ExportSample::positions to the export's world: the body's placement in object space, the
  /// identity in world space.
  Placement transform;
  Placement scene_to_space;  ///< from the scene (m, Y up) to the coordinates of ExportSample::positions
};

/// Takes the next bytes of a file; they are valid during the call only.
using ExportSink = std::function<void(std::span<const std::uint8_t>)>;

/// Frames before a cut of the camera at which it still is where it was, in files whose values go straight from one time
/// to the next.
inline constexpr double kBeforeCut = 1e-3;

/// What one file is made of.
struct ExportTarget {
  ExportSettings settings;
  std::string shot;  ///< its name
  std::vector<ExportBody> bodies;
  SampleTimes times;
  std::function<Camera(double frame)> camera;  ///< the shot's, in the scene (m, Y up)
  /// The last frame in (after, until] at which it jumps, if there is one.
  std::function<std::optional<double>(double after, double until)> camera_cut;
  double aspect = 1;  ///< width of the picture over its height
  ExportSink sink;
  const Threads* threads = nullptr;  ///< for formats that compute; they outlive the writer
  std::string folder;                ///< where scratch files may lie (tool/export/scratch_file.h)
};

/// Writes one file. It holds one sample at most: what the format wants elsewhere than it comes goes to scratch files.
class ExportWriter {
 public:
  virtual ~ExportWriter() = default;

  /// Each body's samples come by time; the bodies of a shot take turns, a frame with what lies before it at once.
  /// Throws work_error for what the format cannot hold (a number that is not finite in its precision), naming the body,
  /// the frame and the vertex.
  virtual void append(const ExportSample& sample) = 0;
  /// After the last sample: what is left of the file. Throws work_error.
  virtual void finish() = 0;
};

/// How the samples of a shot are spread over files.
enum class FilePer {
  Sample,  ///< SHOT.BODY.####.EXTENSION
  Body,    ///< SHOT.BODY.EXTENSION
  Shot     ///< SHOT.EXTENSION
};

/// One file of a series, for its index.
struct SeriesEntry {
  std::string name;  ///< of the file, without folder
  double frame = 0, seconds = 0;
};

/// One line of the table of formats.
struct ExportFormat {
  std::string name;  ///< of --format, and the extension of its files
  std::string about;
  FilePer file_per = FilePer::Sample;
  int version = 1;  ///< of its bytes: raised whenever the same samples make other ones

  bool has_normals = false;    ///< can hold them
  bool has_colors = false;     ///< keeps those of the mesh's vertices, shown or not
  bool has_seconds = false;    ///< knows how fast it plays
  bool has_transform = false;  ///< in object space, it places the body in a world with unit and axes
  bool has_units = true;       ///< false: the format itself fixes metres and Y up
  bool has_voxel = false;      ///< cuts space into voxels, of the size asked for
  bool needs_look = false, needs_camera = false, needs_tets = false;
  bool names_pictures = false;  ///< by where they lie from the file's folder (usda_asset)

  /// Throws input_error for a target that cannot be said in the format.
  std::function<std::unique_ptr<ExportWriter>(ExportTarget)> make;
  /// Of FilePer::Sample: a file that lists the series, SHOT.BODY.index_extension; none if empty.
  std::string index_extension;
  std::function<std::string(std::span<const SeriesEntry>)> make_index;
};

}  // namespace softreel
