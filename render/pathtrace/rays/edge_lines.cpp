#include "render/pathtrace/rays/edge_lines.h"

#include <algorithm>

namespace softreel {

bool on_edge_line(const MotionMesh& mesh, const RayHit& hit, const Ray& ray, float pixel) {
  const EdgeLines& lines = *mesh.lines;
  const Corners p = hit_corners(mesh, hit, ray);
  const Vec3f at = (1 - hit.u - hit.v) * p[0] + hit.u * p[1] + hit.v * p[2];
  // Lengths and areas across the ray: those of the picture, but for its distance.
  std::array<float, 3> lengths, twice_areas;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f edge = p[(k + 1) % 3] - p[k];
    lengths[k] = edge.cross(ray.direction).norm();
    twice_areas[k] = std::abs(edge.cross(at - p[k]).dot(ray.direction));
  }
  const float perimeter = lengths[0] + lengths[1] + lengths[2];
  if (!(perimeter > 0)) return false;
  const float pixel_here = pixel * hit.distance;
  const float radius = (twice_areas[0] + twice_areas[1] + twice_areas[2]) / perimeter;
  const float share = lines.max_share * std::min(1.0f, radius / pixel_here);
  const float half_width = std::min(0.5f * lines.width * pixel_here, share * radius);
  for (std::size_t k = 0; k < 3; ++k) {
    const bool drawn = lines.drawn.empty() || (lines.drawn[static_cast<std::size_t>(hit.triangle)] >> k & 1) != 0;
    if (drawn && twice_areas[k] < half_width * lengths[k]) return true;
  }
  return false;
}

}  // namespace softreel
