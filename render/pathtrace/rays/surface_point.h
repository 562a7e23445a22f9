/// The surface at the end of a ray: position, normals and where to start the next ray.
#pragma once

#include <algorithm>
#include <array>

#include "render/pathtrace/rays/ray_scene.h"

namespace softreel {

/// Positions or normals of the corners of a triangle.
using Corners = std::array<Vec3f, 3>;

/// The step of a mesh's motion that a time falls into, and how far through it.
struct MeshMoment {
  std::size_t step = 0;  ///< between times[step] and times[step + 1]
  float share = 0;
};
MeshMoment moment_of(const MotionMesh& mesh, const Ray& ray);

/// Asks for what surface_point will read, in turn: while it comes from memory there is time for other work.
inline void prefetch_triangle(const MotionMesh& mesh, const RayHit& hit) {
  __builtin_prefetch(mesh.triangles.data() + hit.triangle);
  if (!mesh.normal_triangles.empty()) __builtin_prefetch(mesh.normal_triangles.data() + hit.triangle);
}
void prefetch_corners(const MotionMesh& mesh, const RayHit& hit, const Ray& ray);

/// Where the corners of the triangle that `ray` hit are at the ray's time.
Corners hit_corners(const MotionMesh& mesh, const RayHit& hit, const Ray& ray);

struct SurfacePoint {
  Vec3f position;
  Vec3f geometric_normal;  ///< of the triangle, towards the viewer
  Vec3f shading_normal;    ///< interpolated, towards the viewer
  bool inside = false;     ///< the viewer is behind the triangle: inside a closed mesh
  Vec3f lifted;            ///< start of rays that stay on the viewer's side
  Vec3f lowered;           ///< start of rays that pass through
};

/// How far off a surface rays start: by more than the rounding of coordinates. distance: of the hit.
inline float start_offset(const Vec3f& position, float distance) {
  return 1e-5f * std::max(position.cwiseAbs().maxCoeff(), 1e-3f * distance) + 1e-9f;
}
inline void set_ray_starts(SurfacePoint& point, float distance) {
  const float epsilon = start_offset(point.position, distance);
  point.lifted = point.position + epsilon * point.geometric_normal;
  point.lowered = point.position - epsilon * point.geometric_normal;
}

/// The point of `mesh` that `ray` hit. Corners move on straight lines between the mesh's times.
///
/// lifted: Hanika, Hacking the Shadow Terminator, 2021: on the smooth surface that the vertex normals describe, not on
/// the flat triangle, so that large triangles cast no shadow of their own shape; but for corners whose normal is far
/// from the triangle's, where an edge is sharp. And off the surface by the rounding of its coordinates.
SurfacePoint surface_point(const MotionMesh& mesh, const RayHit& hit, const Ray& ray);

}  // namespace softreel
