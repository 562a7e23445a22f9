#include "core/mesh/vertex_joining.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/mesh/mesh_topology.h"

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
  const std::vector<HalfEdge> sides = sorted_half_edges(welded_triangles(mesh, weld));
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
    if (reaches[v] > 0) rim.push_back(static_cast<Index>(v));
  const auto position = [&](Index v) -> const Vec3& { return mesh.positions[static_cast<std::size_t>(v)]; };
  // By the axis along which the rims reach furthest, a vertex meets only the few that lie in its slice.
  Bounds box;
  for (const Index v : rim) box.add(position(v));
  if (rim.empty()) return weld;
  Index axis = 0;
  box.size().maxCoeff(&axis);
  std::sort(rim.begin(), rim.end(), [&](Index a, Index b) {
    return position(a)[axis] < position(b)[axis] || (position(a)[axis] == position(b)[axis] && a < b);
  });
  DisjointSets sets(mesh.positions.size());
  for (std::size_t i = 0; i < rim.size(); ++i)
    for (std::size_t j = i + 1; j < rim.size(); ++j) {
      const double reach = reaches[static_cast<std::size_t>(rim[i])];
      if (position(rim[j])[axis] - position(rim[i])[axis] > reach) break;
      const double both = std::min(reach, reaches[static_cast<std::size_t>(rim[j])]);
      if ((position(rim[i]) - position(rim[j])).squaredNorm() <= both * both) sets.join(rim[i], rim[j]);
    }
  for (const Index v : rim) joined += sets.root(v) != v ? 1 : 0;
  for (Index& v : weld) v = sets.root(v);
  return weld;
}

}  // namespace softreel
