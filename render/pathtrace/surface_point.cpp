#include "render/pathtrace/surface_point.h"

#include <algorithm>
#include <cmath>

namespace softreel {

namespace {

Corners corners_of(const std::vector<Vec3f>& values, const Triangle& triangle) {
  return {values[static_cast<std::size_t>(triangle[0])], values[static_cast<std::size_t>(triangle[1])],
          values[static_cast<std::size_t>(triangle[2])]};
}

void blend(Corners& a, const Corners& b, float t) {
  for (std::size_t k = 0; k < 3; ++k) a[k] += t * (b[k] - a[k]);
}

/// Turns a normal that faces away from the viewer (at silhouettes of coarse meshes) just enough to be seen edge-on.
Vec3f facing_normal(const Vec3f& normal, const Vec3f& to_viewer) {
  constexpr float kGrazing = 0.01f;
  const float cosine = normal.dot(to_viewer);
  if (cosine >= kGrazing) return normal;
  return (normal + (kGrazing - cosine) * to_viewer).normalized();
}

/// From the flat triangle to the surface bulging out over it: the mean of the feet on the corners' tangent planes.
Vec3f bulge(const Corners& p, const Corners& n, const std::array<float, 3>& weights, const Vec3f& at, float side) {
  Vec3f sum = Vec3f::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const float depth = side * (at - p[k]).dot(n[k]);
    if (depth < 0) sum -= (weights[k] * depth * side) * n[k];
  }
  return sum;
}

}  // namespace

MeshMoment moment_of(const MotionMesh& mesh, const Ray& ray) {
  const std::size_t last = mesh.times.size() - 1;
  const float at = ray.time * static_cast<float>(last);
  const std::size_t step = last == 0 ? 0 : std::min(static_cast<std::size_t>(at), last - 1);
  return {step, at - static_cast<float>(step)};
}

Corners hit_corners(const MotionMesh& mesh, const RayHit& hit, const Ray& ray) {
  const Triangle& triangle = mesh.triangles[static_cast<std::size_t>(hit.triangle)];
  const auto [step, t] = moment_of(mesh, ray);
  Corners p = corners_of(mesh.times[step].positions, triangle);
  if (t > 0) blend(p, corners_of(mesh.times[step + 1].positions, triangle), t);
  return p;
}

SurfacePoint surface_point(const MotionMesh& mesh, const RayHit& hit, const Ray& ray) {
  const Triangle& triangle = mesh.triangles[static_cast<std::size_t>(hit.triangle)];
  const auto [step, t] = moment_of(mesh, ray);
  const MotionMesh::Time& opening = mesh.times[step];
  const Corners p = hit_corners(mesh, hit, ray);

  SurfacePoint point;
  const std::array<float, 3> weights{1 - hit.u - hit.v, hit.u, hit.v};
  point.position = weights[0] * p[0] + weights[1] * p[1] + weights[2] * p[2];
  point.geometric_normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
  point.inside = point.geometric_normal.dot(ray.direction) > 0;
  const float side = point.inside ? -1.0f : 1.0f;
  point.geometric_normal *= side;
  const float epsilon = 1e-5f * std::max(point.position.cwiseAbs().maxCoeff(), 1e-3f * hit.distance) + 1e-9f;
  point.lifted = point.position + epsilon * point.geometric_normal;
  point.lowered = point.position - epsilon * point.geometric_normal;
  point.shading_normal = point.geometric_normal;
  if (opening.normals.empty()) return point;
  Corners n = corners_of(opening.normals, triangle);
  if (t > 0) blend(n, corners_of(mesh.times[step + 1].normals, triangle), t);
  const Vec3f mean = side * (weights[0] * n[0] + weights[1] * n[1] + weights[2] * n[2]);
  const float length = mean.norm();
  if (length > 1e-6f) point.shading_normal = facing_normal(mean / length, -ray.direction);
  point.lifted += bulge(p, n, weights, point.position, side);
  return point;
}

}  // namespace softreel
