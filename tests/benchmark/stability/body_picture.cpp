#include "tests/benchmark/stability/body_picture.h"

#include <limits>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/report/studio.h"

namespace softreel::bench {
namespace {

constexpr float kLineWidth = 1.6f;  ///< pixels

struct Reach {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

Reach reach_of(const std::vector<Vec3>& positions, const Vec3& direction) {
  Reach reach;
  for (const Vec3& p : positions) {
    reach.low = std::min(reach.low, p.dot(direction));
    reach.high = std::max(reach.high, p.dot(direction));
  }
  return reach;
}

MotionMesh faces_of(const PosedBody& body, const StudioPlace& place) {
  MotionMesh mesh = studio_mesh("body", body.color, Vec3f(0.25f * body.color), kLineWidth);
  for (const Triangle& face : boundary_faces(*body.mesh)) {
    const auto at = [&](std::size_t k) { return place(body.positions[static_cast<std::size_t>(face[k])]); };
    add_triangle(mesh, at(0), at(1), at(2));
  }
  return mesh;
}

}  // namespace

std::vector<PosedBody> in_a_row(std::vector<PosedBody> bodies, const Vec3& direction, double gap) {
  double end = 0;
  for (PosedBody& body : bodies) {
    const Reach reach = reach_of(body.positions, direction);
    for (Vec3& p : body.positions) p += (end - reach.low) * direction;
    end += reach.high - reach.low + gap;
  }
  return bodies;
}

void add_body_picture(Report& report, const std::vector<PosedBody>& bodies, const Vec3& facing, const std::string& file,
                      const std::string& size, const std::string& caption) {
  Bounds box;
  for (const PosedBody& body : bodies)
    for (const Vec3& p : body.positions) box.add(p);
  const StudioPlace place(box);
  std::vector<MotionMesh> meshes;
  for (const PosedBody& body : bodies) meshes.push_back(faces_of(body, place));
  PictureOptions options;
  options.path = (report.folder() / file).string();
  options.size = size;
  try {
    check_picture(options);
  } catch (const Error& error) {
    report.say(fmt::format("No picture {}: {}", file, error.what()));
    return;
  }
  draw_in_studio(std::move(meshes), facing, options, Threads(1));
  report.add_picture(file, caption);
}

}  // namespace softreel::bench
