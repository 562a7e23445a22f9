#include "render/pathtrace/rays/surface_point.h"

#include <algorithm>
#include <cmath>

namespace softreel {

namespace {

inline Corners corners_of(const std::vector<Vec3f>& values, const Triangle& triangle) {
  return {values[static_cast<std::size_t>(triangle[0])], values[static_cast<std::size_t>(triangle[1])],
          values[static_cast<std::size_t>(triangle[2])]};
}

void blend(Corners& a, const Corners& b, float t) {
  for (std::size_t k = 0; k < 3; ++k) a[k] += t * (b[k] - a[k]);
}

/// Of the mesh at a moment. of_time: the positions or the normals. Always inlined: it is half of what a hit costs.
[[gnu::always_inline]] inline Corners moving_corners(const MotionMesh& mesh,
                                                     std::vector<Vec3f> MotionMesh::Time::*of_time,
                                                     const Triangle& triangle, const MeshMoment& moment) {
  Corners corners = corners_of(mesh.times[moment.step].*of_time, triangle);
  if (moment.share > 0) blend(corners, corners_of(mesh.times[moment.step + 1].*of_time, triangle), moment.share);
  return corners;
}

/// Turns a normal that faces away from the viewer (at silhouettes of coarse meshes) just enough to be seen edge-on.
Vec3f facing_normal(const Vec3f& normal, const Vec3f& to_viewer) {
  constexpr float kGrazing = 0.01f;
  const float cosine = normal.dot(to_viewer);
  if (cosine >= kGrazing) return normal;
  return (normal + (kGrazing - cosine) * to_viewer).normalized();
}

/// How far a corner's normal may be trusted to be that of a round surface, by its cosine with the triangle's own: not
/// where sharp edges were averaged, as at the corners of a box of twelve triangles, whose faces are flat.
float roundness(float cosine) {
  constexpr float kSharp = 0.7f, kRound = 0.9f;
  const float t = std::clamp((cosine - kSharp) / (kRound - kSharp), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

/// From the flat triangle to the surface bulging out over it: the mean of the feet on the corners' tangent planes.
[[gnu::always_inline]] inline Vec3f bulge(const Corners& p, const Corners& n, const std::array<float, 3>& weights,
                                          const SurfacePoint& point, float side) {
  Vec3f sum = Vec3f::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    // No branch: which corners are above is as good as chance.
    const float depth = std::min(side * (point.position - p[k]).dot(n[k]), 0.0f);
    const float round = roundness(side * n[k].dot(point.geometric_normal));
    sum -= (weights[k] * depth * side * round) * n[k];
  }
  return sum;
}

}  // namespace

MeshMoment moment_of(const MotionMesh& mesh, const Ray& ray) {
  const std::size_t last = mesh.times.size() - 1;
  if (last == 0) return {};
  const float at = ray.time * static_cast<float>(last);
  const std::size_t step = std::min(static_cast<std::size_t>(at), last - 1);
  return {step, at - static_cast<float>(step)};
}

void prefetch_corners(const MotionMesh& mesh, const RayHit& hit, const Ray& ray) {
  const Triangle& triangle = mesh.triangles[static_cast<std::size_t>(hit.triangle)];
  const Triangle& normals = mesh.corners_of_normals()[static_cast<std::size_t>(hit.triangle)];
  const std::size_t step = moment_of(mesh, ray).step, last = mesh.times.size() - 1;
  for (std::size_t k = step; k <= std::min(step + 1, last); ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      __builtin_prefetch(mesh.times[k].positions.data() + triangle[c]);
      if (!mesh.times[k].normals.empty()) __builtin_prefetch(mesh.times[k].normals.data() + normals[c]);
    }
}

Corners hit_corners(const MotionMesh& mesh, const RayHit& hit, const Ray& ray) {
  return moving_corners(mesh, &MotionMesh::Time::positions, mesh.triangles[static_cast<std::size_t>(hit.triangle)],
                        moment_of(mesh, ray));
}

SurfacePoint surface_point(const MotionMesh& mesh, const RayHit& hit, const Ray& ray) {
  const Triangle& triangle = mesh.triangles[static_cast<std::size_t>(hit.triangle)];
  const MeshMoment moment = moment_of(mesh, ray);
  const Corners p = moving_corners(mesh, &MotionMesh::Time::positions, triangle, moment);

  SurfacePoint point;
  const std::array<float, 3> weights{1 - hit.u - hit.v, hit.u, hit.v};
  point.position = weights[0] * p[0] + weights[1] * p[1] + weights[2] * p[2];
  point.geometric_normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
  point.inside = point.geometric_normal.dot(ray.direction) > 0;
  const float side = point.inside ? -1.0f : 1.0f;
  point.geometric_normal *= side;
  set_ray_starts(point, hit.distance);
  point.shading_normal = point.geometric_normal;
  if (mesh.times.front().normals.empty()) return point;
  const Triangle& normals = mesh.corners_of_normals()[static_cast<std::size_t>(hit.triangle)];
  const Corners n = moving_corners(mesh, &MotionMesh::Time::normals, normals, moment);
  const Vec3f mean = side * (weights[0] * n[0] + weights[1] * n[1] + weights[2] * n[2]);
  const float length = mean.norm();
  if (length > 1e-6f) point.shading_normal = facing_normal(mean / length, -ray.direction);
  point.lifted += bulge(p, n, weights, point, side);
  return point;
}

}  // namespace softreel
