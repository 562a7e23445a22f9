/// A studio for pictures of meshes: light ground, soft light, and a camera that frames what stands in it.
#pragma once

#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "render/scene/scene.h"

namespace softreel {

/// What a command was asked for on its line.
struct PictureOptions {
  std::string path;  ///< file to write, .png; empty: no picture
  std::string cut;   ///< see cut_plane in cut_plane.h; empty: chosen
  std::string size = "1600x1200";
};

struct PictureSize {
  int width = 0, height = 0;  ///< pixels
};

/// Throws input_error for a file that is no PNG, a size that is none, or a build without the path tracer: called
/// before long work. Of options without a path it says nothing.
void check_picture(const PictureOptions& options);

/// "1600x1200"; 16 to 8192 pixels either way. Throws input_error.
PictureSize parse_picture_size(const std::string& text);

/// From a mesh's own unit and origin to the studio, where its box has the diagonal 1 and stands on y = 0 around the
/// origin.
struct StudioPlace {
  explicit StudioPlace(const Bounds& box);
  Vec3f operator()(const Vec3& p) const { return (scale * (p - origin)).cast<float>(); }

  Vec3 origin;
  double scale;
};

/// A matt mesh without triangles, lit flat, with lines along its edges if `line_width` (pixels of a picture that is
/// 1600 wide) is above 0. Colours are linear albedo.
MotionMesh studio_mesh(const char* name, const Vec3f& color, const Vec3f& line_color, float line_width);
void add_triangle(MotionMesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c);

/// Traces the meshes, placed by StudioPlace, and writes the picture to options.path, complete or not at all.
/// facing: what shows best is seen by who looks against it; the camera stands a little to the side of it and above.
/// Throws work_error, or input_error as check_picture does. The bits do not depend on the number of threads.
void draw_in_studio(std::vector<MotionMesh> meshes, const Vec3& facing, const PictureOptions& options,
                    const Threads& threads);

}  // namespace softreel
