#include "render/preview/depth_range.h"

#include <algorithm>
#include <limits>

#include <Eigen/Geometry>

namespace softreel {
namespace {

/// Least depth at which a plane is seen; infinite if it is not. The inverse of the depth is linear over the picture, so
/// that it is greatest at a corner, however the camera is rolled.
float nearest_of_plane(const Vec3f& point, const Vec3f& normal, const CameraFrame& camera) {
  float nearest = std::numeric_limits<float>::infinity();
  const float offset = normal.dot(point - camera.position);
  for (const float x : {-1.0f, 1.0f})
    for (const float y : {-1.0f, 1.0f}) {
      const float depth = offset / normal.dot(camera.window_point(x, y));
      if (depth > 0) nearest = std::min(nearest, depth);
    }
  return nearest;
}

/// No point of the ground that is seen is nearer. Its triangles as endless planes: a plane and a backdrop are the
/// border of something convex, which a ray from inside leaves at the first of these.
float nearest_of_ground(const MotionMesh& ground, const CameraFrame& camera) {
  float nearest = std::numeric_limits<float>::infinity();
  if (ground.times.empty()) return nearest;
  const std::vector<Vec3f>& positions = ground.times.back().positions;
  for (const Triangle& t : ground.triangles) {
    const Vec3f &a = positions[static_cast<std::size_t>(t[0])], &b = positions[static_cast<std::size_t>(t[1])],
                &c = positions[static_cast<std::size_t>(t[2])];
    nearest = std::min(nearest, nearest_of_plane(a, (b - a).cross(c - a), camera));
  }
  return nearest;
}

}  // namespace

DepthRange depth_range(const std::vector<MotionMesh>& meshes, const MotionMesh& ground, const GizmoMarks& marks,
                       const std::vector<LampCorner>& lamps, const CameraFrame& camera) {
  float near = std::numeric_limits<float>::infinity(), far = 1;
  const auto depth_of = [&](const Vec3f& p) { return (p - camera.position).dot(camera.forward); };
  const auto add = [&](const Vec3f& p) {
    const float depth = depth_of(p);
    far = std::max(far, depth);
    if (depth > 0) near = std::min(near, depth);
  };
  for (const MotionMesh& mesh : meshes)
    for (const Vec3f& p : mesh.times.back().positions) add(p);
  if (!ground.times.empty())
    for (const Vec3f& p : ground.times.back().positions) far = std::max(far, depth_of(p));
  for (const LampCorner& corner : lamps) add(corner.position);
  for (const GizmoMarks::Dot& dot : marks.dots) add(dot.at);
  for (const GizmoMarks::Line& line : marks.lines) {
    add(line.from);
    add(line.to);
  }
  far *= 1.01f;
  const float least = 1e-5f * far;
  near = std::clamp(0.5f * near, least, 1e-3f * far);
  return {std::clamp(0.5f * nearest_of_ground(ground, camera), least, near), far};
}

}  // namespace softreel
