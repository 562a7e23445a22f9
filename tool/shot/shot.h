/// A shot as its file says it: plain values, every field checked, nothing loaded yet.
///
/// tool/shot/schema holds the one table of fields that reads, checks and documents these structs.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/constraints/followed_surface.h"
#include "core/constraints/keys.h"
#include "core/constraints/selection.h"
#include "core/dynamics/simulator.h"
#include "core/elasticity/material.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "render/image/image_io.h"
#include "render/pathtrace/path_tracer.h"
#include "render/scene/scene.h"

namespace softreel {

/// Where a value was written: a file with line and column, or "--set" with line 0.
struct Origin {
  std::string file;
  int line = 0, column = 0;
  std::string changed_by = {};  ///< an option that changed a part of it, "--set"; empty: none
};

/// "FILE:LINE:COLUMN", or the file alone where there is no line, and what changed a part of it.
std::string to_string(const Origin& origin);

/// One value at all frames.
template <typename T>
Track<T> constant_track(const T& value) {
  return {{{0, value, Ease::Smooth}}};
}

enum class StartState { Rest, Equilibrium };
enum class SimulationMode { Dynamic, Static };
enum class UpAxis { X, Y, Z };

struct ShotSettings {
  std::string name;  ///< names the files of the output; default: the shot file's stem
  double fps = 24;
  int first_frame = 1, last_frame = 96;
  int preroll = 0;  ///< frames simulated before the first, not rendered, at the frame numbers before it
  StartState start = StartState::Rest;
  SimulationMode mode = SimulationMode::Dynamic;
  bool independent = false;  ///< statics: every frame starts from rest
};

/// What varies the look of a material over its surface. Paths are resolved; empty: the appearance's value everywhere.
struct TextureSettings {
  std::string base_color, roughness, normal, bump;
  bool vertex_colors = false;  ///< of the mesh file, as base colour
  TextureWrap wrap = TextureWrap::Repeat;
  Vec2 scale = Vec2::Ones(), offset = Vec2::Zero();
  double normal_strength = 1;
  double bump_height = 0.01;  ///< m

  /// In the order of the members.
  std::array<std::string*, 4> paths() { return {&base_color, &roughness, &normal, &bump}; }
  bool any() const { return !base_color.empty() || !roughness.empty() || !normal.empty() || !bump.empty(); }
};

/// A visible property that changes over the frames: of a number or of a colour.
struct AppearanceTrack {
  std::string field;  ///< of the material
  float Appearance::*number = nullptr;
  Track<double> numbers;
  Vec3f Appearance::*color = nullptr;
  Track<Vec3> colors;
};

/// Physical and visible properties under one name.
struct MaterialSettings {
  ElementMaterial physics;
  Appearance appearance;                ///< keyed properties as at their first key
  std::vector<AppearanceTrack> tracks;  ///< of the keyed properties
  TextureSettings textures;
  Origin origin;  ///< of the table
};

/// A length, or a share of the diagonal of a body's box.
struct BodyLength {
  double value = 0;       ///< m, or share of the diagonal; 0: not given
  bool is_share = false;  ///< of the diagonal

  double in_meters(double diagonal) const { return is_share ? value * diagonal : value; }
  friend bool operator==(const BodyLength&, const BodyLength&) = default;
};

/// Where regions overlap, the later one holds.
struct RegionSettings {
  Selection select;
  std::optional<std::string> material;  ///< name of a material, or
  std::optional<double> stiffness;      ///< factor on the body's Young's modulus
  Origin origin;
};

/// What pins and pulls follow instead of keys.
struct FollowSettings {
  std::string file;                 ///< resolved path of a scene or point cache
  std::string node;                 ///< of the scene, followed rigidly; or
  std::string mesh;                 ///< its surface; both empty: the surface of all meshes
  std::string clip;                 ///< empty: the only one
  std::optional<double> start;      ///< frame at which the clip starts; none: the shot's first frame
  double speed = 1;                 ///< seconds of the clip a second of the shot
  std::optional<double> reference;  ///< frame at which it belongs to the body at rest; none: the file's rest pose
  bool in_scene = false;            ///< the file's numbers are metres in the scene; false: placed as the body's mesh
  std::optional<FollowedSurface::Binding> bind;  ///< none: by vertex where their number and no reference allows it
  Origin origin;
};

struct PinSettings {
  Selection select;
  Track<Transform> keys;     ///< at least one key (none in the file: one that moves nothing)
  bool pivot_given = false;  ///< false: the centroid of the selected points is the pivot of every key
  bool keys_in_box = false;  ///< translate of the keys counts in heights, pivot in coordinates of the placed body's box
  std::vector<FrameRange> active;
  std::optional<FollowSettings> follow;  ///< instead of keys
  bool grab = false;                     ///< takes the points where they are when it starts
  Origin origin;
};

struct PullSettings {
  Selection select;  ///< no term: with weights, the points of a weight above 0
  Track<Transform> keys;
  bool pivot_given = false;
  bool keys_in_box = false;  ///< translate of the keys counts in heights, pivot in coordinates of the placed body's box
  Track<double> stiffness;   ///< N/m, of all springs together
  double falloff = 0;        ///< m; weights fall smoothly to 0 at this distance from the selection's centre; 0: equal
  double max_force = 0;      ///< N; 0: no limit
  std::vector<FrameRange> active;
  std::optional<FollowSettings> follow;  ///< instead of keys
  bool grab = false;                     ///< takes the points where they are when it starts
  std::optional<WeightSource> weights;   ///< factor on each point's share of the stiffness
  Origin origin;
};

/// Surfaces of two bodies held together.
struct GlueSettings {
  std::vector<std::string> bodies;    ///< two names
  Selection select{{{SelectAll{}}}};  ///< which points of the first body may stick
  double distance = 0;                ///< m; farthest from the second body's surface where the glue starts
  Track<double> stiffness;            ///< N/m, of all bonds together; no keys: firm (core/constraints/glue.h)
  double close = 0;                   ///< frames in which gaps close; 0: they stay
  double max_force = 0;               ///< N; 0: no limit
  std::vector<FrameRange> active;
  Origin origin;
};

/// Of a body where neither the shot nor the error dial says how many.
inline constexpr std::int64_t kDefaultTets = 20000;

struct BodySettings {
  std::string name;
  std::string mesh;  ///< resolved path
  UpAxis up = UpAxis::Y;
  double fit = 0;                  ///< height in m, stood on the ground; 0: as in the file
  double scale = 1;                ///< factor on the file's numbers where there is no fit
  Vec3 translate = Vec3::Zero();   ///< m
  Vec3 rotate_deg = Vec3::Zero();  ///< about x, then y, then z
  std::string material;            ///< name
  std::string tetrahedra;          ///< resolved path of given tetrahedra; or
  double edge = 0;                 ///< m; or
  std::int64_t tets = 0;           ///< number of tetrahedra; or
  BodyLength error;                ///< largest distance to the surface; one of the four is set, or solver.error chooses
  bool graded = false;             ///< with tets or edge: sizes by what the surface asks for
  TetMode mode = TetMode::Conforming;
  bool optimize = false;                   ///< makes the worst angles of the tetrahedra better
  double thickness = 0;                    ///< m, of open sheets; 0: none
  std::optional<RotationMethod> rotation;  ///< instead of the solver's
  double crease_deg = 180;                 ///< edges at which triangles meet by more, at rest, are shaded hard
  std::vector<RegionSettings> regions;
  std::vector<PinSettings> pins;
  std::vector<PullSettings> pulls;
  Origin origin;       ///< of the table
  Origin mesh_origin;  ///< of the mesh field

  /// Whether any edge can be shaded hard.
  bool has_creases() const { return crease_deg < 180; }
};

enum class CameraMode {
  Frame,  ///< frames all bodies at rest, from azimuth and elevation
  Place   ///< keyed position and target
};

struct CameraSettings {
  CameraMode mode = CameraMode::Frame;
  double azimuth_deg = 30;  ///< about the vertical; 0 looks along -z (from the front)
  double elevation_deg = 12;
  double margin = 1.35;           ///< size of the picture over that of the bodies
  Vec3 shift = Vec3::Zero();      ///< of the target, in heights of the bodies' box
  Track<Vec3> position, target;   ///< Place
  Track<double> focal_length_mm;  ///< at least one key
  Track<double> focus_distance;   ///< empty: at the target
  double sensor_width_mm = 36;
  double f_number = 0;
  Origin origin;
};

enum class LightKind { Area, Disk, Sphere, Sun };

/// A light in the words of a shot.
struct LightSettings {
  LightKind kind = LightKind::Area;
  Track<Vec3> center = constant_track(Vec3(0, 4, 0));        ///< all but the sun: m
  Track<Vec3> aim = constant_track(Vec3(0, 0, 0));           ///< area, disk: the point it faces, m
  Vec2 size = Vec2(1, 1);                                    ///< area, disk: width and height, m
  double radius = 0.25;                                      ///< sphere: m
  Track<double> power = constant_track(100.0);               ///< all but the sun: W
  bool visible = true;                                       ///< all but the sun: to camera rays
  Track<Vec3> direction = constant_track(Vec3(-1, -2, -1));  ///< sun: the way its light travels, any length
  Track<double> irradiance = constant_track(1.0);            ///< sun: W/m^2 on a surface that faces it, times color
  double angle_deg = 0.53;                                   ///< sun: diameter of its disk
  Track<Vec3> color = constant_track(Vec3(1, 1, 1));         ///< linear
  Origin origin;
};

/// Daylight in the words of a shot.
struct SkySettings {
  Track<double> turbidity = constant_track(3.0);
  Track<double> elevation_deg = constant_track(45.0);  ///< of the sun
  Track<double> azimuth_deg = constant_track(35.0);    ///< of the sun; 0: in front
  double ground_albedo = 0.2;
  bool sun = true;  ///< with the sun's own light
  double sun_angle_deg = 0.53;
  Origin origin;
};

/// A quantity of the simulation that is shown as colour on all bodies.
enum class HeatQuantity {
  None,
  Strain,       ///< largest principal strain (stretch - 1) by magnitude, 1
  Stress,       ///< von Mises stress, Pa
  Displacement  ///< distance from the place at rest, m
};

struct HeatSettings {
  HeatQuantity quantity = HeatQuantity::None;
  std::optional<Vec2> range;  ///< of the colours, in the quantity's unit; none: found from all frames of the shot
};

struct RenderSettings {
  int width = 960, height = 540;  ///< pixels
  double scale = 1;               ///< of the picture over width and height
  RenderParams params;            ///< its width and height: those of the picture that is made
  HeatSettings heat;
  double shutter = 0;            ///< share of a frame that the shutter is open, ending at the frame; 0: no motion blur
  int blur_segments = 2;         ///< straight pieces of each point's path while the shutter is open
  ShutterCurve curve;            ///< of the shutter
  Vec4 crop = Vec4(0, 0, 1, 1);  ///< left, top, right, bottom, shares of the picture
  double overscan = 0;           ///< share of the picture that is added at each side
};

struct OutputSettings {
  std::string directory = "out";  ///< relative to the working directory
  ViewTransform view = ViewTransform::Filmic;
  double exposure = 0;  ///< stops
  bool png = true, exr = false, movie = true;
  bool burn_in = false;        ///< shot and frame number in the PNG
  bool contact_sheet = false;  ///< SHOT.sheet.png
  double cache_limit_gb = 20;  ///< of stored results; 0: no limit
};

struct GoldenSettings {
  std::vector<int> frames;  ///< empty: first, middle and last
  double threshold = 0.15;  ///< largest allowed FLIP error of a block
  int max_width = 480, max_samples = 16;
};

/// The error dial: what it chooses is 0 in the shot, and filled in body by body (tool/bodies/dial_stage.h).
struct DialSettings {
  double error = 0;                 ///< wanted error of the motion over the diagonal of a body's box; 0: no dial
  std::int64_t max_tets = 1000000;  ///< of a body
  bool is_on() const { return error > 0; }
};

struct Shot {
  std::string path;  ///< the file as given
  ShotSettings settings;
  std::vector<BodySettings> bodies;  ///< in the order of the file
  std::map<std::string, MaterialSettings> materials;
  std::vector<GlueSettings> glues;
  SolverParams solver;
  DialSettings dial;
  int threads = 0;  ///< 0: all processors
  Vec3 gravity = Vec3(0, -9.81, 0);
  CameraSettings camera;
  std::vector<LightSettings> lights;  ///< in the order of the file; lights_at makes the renderer's of them
  Environment environment;            ///< its image, strength and rotation: see below
  Track<double> environment_strength = constant_track(1.0);
  Track<double> environment_rotation_deg = constant_track(0.0);
  std::string environment_image;   ///< resolved path; empty: gradient or sky
  std::optional<SkySettings> sky;  ///< instead of gradient and image
  Origin environment_origin;
  std::optional<Ground> ground;
  RenderSettings render;
  OutputSettings output;
  GoldenSettings golden;
};

/// What of the picture crop and overscan leave, in its pixels; all 0 where they say nothing.
PixelWindow window_of(const RenderSettings& render);

/// The solver of one body: the shot's, with what the body says of its own.
SolverParams solver_of(const Shot& shot, const BodySettings& body);

}  // namespace softreel
