#include "core/tetmesh/quality/tet_quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/tetmesh/farthest_point.h"
#include "core/tetmesh/surface/hidden_surface.h"
#include "core/tetmesh/surface/hole_caps.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

constexpr std::int64_t kQualityGrain = 8192;

std::array<Vec3, 4> corners_of(const TetMesh& mesh, std::size_t e) {
  std::array<Vec3, 4> x;
  for (std::size_t k = 0; k < 4; ++k) x[k] = mesh.nodes[static_cast<std::size_t>(mesh.tets[e][k])];
  return x;
}

/// Nothing nearer to the boundary than this share of the box's diagonal is taken for hidden.
constexpr double kHiddenDepth = 1e-3;

/// A smaller share of an area is what sums round off.
constexpr double kRoundOff = 1e-9;

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

double area_of(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  double area = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3& x = points[static_cast<std::size_t>(a)];
    area += 0.5 * (points[static_cast<std::size_t>(b)] - x).cross(points[static_cast<std::size_t>(c)] - x).norm();
  }
  return area;
}

/// Measures the boundary again without the caps of holes, if there are any, where it is further away than `limit`.
void leave_out_caps(const SurfaceMesh& surface, const TriangleTree& tree, const std::vector<Vec3>& nodes,
                    const std::vector<Triangle>& boundary, double limit, const Threads& threads,
                    SurfaceDeviation& deviation) {
  const HoleCaps caps(surface.positions, surface.triangles, tree);
  if (!caps.any() || boundary.empty() || deviation.from_boundary <= limit) return;
  const SurfaceMesh rest = caps.without_caps(nodes, boundary, limit, threads);
  const double share = 1 - area_of(rest.positions, rest.triangles) / area_of(nodes, boundary);
  deviation.cap_share = share > kRoundOff ? share : 0;
  deviation.from_boundary = farthest_distance(rest.positions, rest.triangles, tree, threads);
}

}  // namespace

DihedralRange dihedral_range(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // Outward normals; the angle at an edge is the supplement of that between the normals of its two faces.
  std::array<Vec3, 4> normals{(c - b).cross(d - b), (d - a).cross(c - a), (b - a).cross(d - a), (c - a).cross(b - a)};
  for (Vec3& normal : normals) normal /= normal.norm();
  double low = 1, high = -1;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double cosine = -normals[i].dot(normals[j]);
      if (!(cosine >= low)) low = cosine;
      if (!(cosine <= high)) high = cosine;
    }
  const auto angle = [](double cosine) {
    return std::acos(std::isnan(cosine) ? cosine : std::clamp(cosine, -1.0, 1.0));
  };
  return {angle(high), angle(low)};
}

TetQuality measure_quality(const TetMesh& mesh, const Threads& threads) {
  TetQuality quality;
  if (mesh.tets.empty()) return quality;
  std::vector<DihedralRange> angles(mesh.tets.size());
  std::vector<double> volumes(mesh.tets.size());
  threads.for_chunks(static_cast<std::int64_t>(mesh.tets.size()), kQualityGrain,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
                         const auto [a, b, c, d] = corners_of(mesh, e);
                         angles[e] = dihedral_range(a, b, c, d);
                         volumes[e] = tet_volume(a, b, c, d);
                       }
                     });
  std::size_t least = 0, most = 0, smallest = 0;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    if (!(angles[e].min >= angles[least].min)) least = e;
    if (!(angles[e].max <= angles[most].max)) most = e;
    if (!(volumes[e] >= volumes[smallest])) smallest = e;
    quality.volume += mesh.fill_of(e) * volumes[e];
  }
  quality.min_dihedral = degrees(angles[least].min);
  quality.min_dihedral_tet = static_cast<Index>(least);
  quality.max_dihedral = degrees(angles[most].max);
  quality.max_dihedral_tet = static_cast<Index>(most);
  quality.min_volume = volumes[smallest];
  quality.min_volume_tet = static_cast<Index>(smallest);
  const auto percentile = static_cast<std::ptrdiff_t>(angles.size() / 100);
  std::nth_element(angles.begin(), angles.begin() + percentile, angles.end(),
                   [](const DihedralRange& x, const DihedralRange& y) { return x.min < y.min; });
  quality.first_percentile_dihedral = degrees(angles[static_cast<std::size_t>(percentile)].min);
  return quality;
}

SurfaceDeviation measure_deviation(const SurfaceMesh& surface, const TetMesh& mesh, const Threads& threads) {
  const std::vector<Triangle> boundary = boundary_faces(mesh);
  const TriangleTree surface_tree(surface.positions, surface.triangles), boundary_tree(mesh.nodes, boundary);
  SurfaceDeviation deviation;
  deviation.from_boundary = farthest_distance(mesh.nodes, boundary, surface_tree, threads);
  deviation.from_surface = farthest_distance(surface.positions, surface.triangles, boundary_tree, threads);
  const double diagonal = used_bounds(surface).diagonal();
  leave_out_caps(surface, surface_tree, mesh.nodes, boundary, kHiddenDepth * diagonal, threads, deviation);
  // Distances of hidden pieces are a good share of the body's thickness; a surface that is followed has none such.
  const double limit = std::max(deviation.from_boundary, kHiddenDepth * diagonal);
  if (deviation.from_surface <= limit || boundary.empty()) return deviation;
  const std::vector<std::uint8_t> suspected =
      find_far_triangles(surface.positions, surface.triangles, boundary_tree, limit, threads);
  const SurfaceMesh visible = without_hidden(surface, suspected, 0.5 * limit, threads);
  deviation.from_surface = farthest_distance(visible.positions, visible.triangles, boundary_tree, threads);
  return deviation;
}

}  // namespace softreel
