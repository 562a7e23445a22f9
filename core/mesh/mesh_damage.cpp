#include "core/mesh/mesh_damage.h"

#include <algorithm>

#include "core/mesh/mesh_topology.h"

namespace softreel {
namespace {

/// The same cycle of corners, smallest first: equal for triangles on the same corners that face the same way.
Triangle rotated(const Triangle& t) {
  if (t[1] < t[0] && t[1] < t[2]) return {t[1], t[2], t[0]};
  if (t[2] < t[0] && t[2] < t[1]) return {t[2], t[0], t[1]};
  return t;
}

std::vector<Index> turned_triangles(const std::vector<Triangle>& before, const SurfaceMesh& repaired) {
  std::vector<Triangle> after = welded_triangles(repaired);
  for (Triangle& triangle : after) triangle = rotated(triangle);
  std::sort(after.begin(), after.end());
  const auto has = [&](const Triangle& t) { return std::binary_search(after.begin(), after.end(), rotated(t)); };
  std::vector<Index> turned;
  for (std::size_t t = 0; t < before.size(); ++t) {
    const auto& [a, b, c] = before[t];
    if (!is_collapsed(before[t]) && !has({a, b, c}) && has({a, c, b})) turned.push_back(static_cast<Index>(t));
  }
  return turned;
}

}  // namespace

MeshDamage find_damage(const SurfaceMesh& mesh, const SurfaceMesh& repaired) {
  const std::vector<Triangle> welded = welded_triangles(mesh);
  MeshDamage damage;
  const std::vector<HalfEdge> sides = sorted_half_edges(welded);
  for_each_edge(sides, [&](std::span<const HalfEdge> edge) {
    const MeshDamage::Edge ends{edge[0].low, edge[0].high};
    if (edge.size() == 1) damage.boundary.push_back(ends);
    if (edge.size() > 2) damage.non_manifold.push_back(ends);
    if (edge.size() == 2 && edge[0].forward == edge[1].forward) damage.flipped.push_back(ends);
  });
  damage.turned = turned_triangles(welded, repaired);
  return damage;
}

}  // namespace softreel
