#include "core/mesh/vertex_joining.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/mesh/mesh_topology.h"
#include "core/mesh/point_tree.h"

namespace softreel {
namespace {

/// Of the box's diagonal; above the rounding of floats in a file, below what is modelled.
constexpr double kReach = 1e-5;

/// Of the shortest edge at a vertex, so that no triangle collapses.
constexpr double kShareOfEdge = 0.25;

/// How far each welded vertex on a rim may be moved, m; 0 for all others.
std::vector<double> rim_reaches(const SurfaceMesh& mesh, const std::vector<Index>& weld) {
  std::vector<double> reaches(mesh.positions.size(), 0.0);
  const double most = kReach * used_bounds(mesh).diagonal();
  const std::vector<HalfEdge> sides = sorted_half_edges(welded_triangles(mesh.triangles, weld));
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    if (edge.size() == 1)
      for (const Index v : {edge[0].low, edge[0].high}) reaches[static_cast<std::size_t>(v)] = most;
  });
  for (const HalfEdge& side : sides) {
    const auto low = static_cast<std::size_t>(side.low), high = static_cast<std::size_t>(side.high);
    const double length = kShareOfEdge * (mesh.positions[low] - mesh.positions[high]).norm();
    reaches[low] = std::min(reaches[low], length);
    reaches[high] = std::min(reaches[high], length);
  }
  return reaches;
}

}  // namespace

std::vector<Index> join_vertices(const SurfaceMesh& mesh, std::int64_t& joined) {
  joined = 0;
  std::vector<Index> weld = weld_positions(mesh.positions);
  const std::vector<double> reaches = rim_reaches(mesh, weld);
  std::vector<Index> rim;
  for (std::size_t v = 0; v < reaches.size(); ++v)
    if (reaches[v] > 0 && std::isfinite(reaches[v])) rim.push_back(static_cast<Index>(v));
  if (rim.empty()) return weld;
  const auto reach = [&](Index v) { return reaches[static_cast<std::size_t>(v)]; };
  const auto position = [&](Index v) -> const Vec3& { return mesh.positions[static_cast<std::size_t>(v)]; };
  DisjointSets sets(mesh.positions.size());
  std::vector<Vec3> places;
  for (const Index v : rim) places.push_back(position(v));
  const PointTree tree(std::move(places));
  // Asked with each one's own reach: one used vertex far away makes the others' limit large, not their edges.
  for (const Index v : rim)
    tree.visit_near(position(v), reach(v), [&](Index i) {
      const Index other = rim[static_cast<std::size_t>(i)];
      const double both = std::min(reach(v), reach(other));
      if (other != v && (position(v) - position(other)).squaredNorm() <= both * both) sets.join(v, other);
    });
  for (const Index v : rim) joined += sets.root(v) != v ? 1 : 0;
  for (Index& v : weld) v = sets.root(v);
  return weld;
}

}  // namespace softreel
