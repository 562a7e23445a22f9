#include "core/tetmesh/quality/tunnels.h"

#include <algorithm>
#include <vector>

#include "core/mesh/disjoint_sets.h"
#include "core/mesh/mesh_topology.h"

namespace softreel {

std::optional<Index> count_tunnels(std::span<const Triangle> triangles) {
  const std::vector<HalfEdge> sides = sorted_half_edges(triangles);
  DisjointSets corners(3 * triangles.size()), pieces(triangles.size());
  std::int64_t edges = 0;
  bool is_closed = true;
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    ++edges;
    if (edge.size() != 2) {
      is_closed = false;
      return;
    }
    pieces.join(edge[0].triangle, edge[1].triangle);
    for (const Index vertex : {edge[0].low, edge[0].high})
      corners.join(corner_of(triangles, edge[0].triangle, vertex), corner_of(triangles, edge[1].triangle, vertex));
  });
  if (!is_closed) return std::nullopt;
  std::int64_t vertices = 0, faces = 0, count = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (is_collapsed(triangles[t])) continue;
    const auto triangle = static_cast<Index>(t);
    ++faces;
    count += pieces.root(triangle) == triangle ? 1 : 0;
    for (Index corner = 3 * triangle; corner < 3 * triangle + 3; ++corner)
      vertices += corners.root(corner) == corner ? 1 : 0;
  }
  return static_cast<Index>(count - (vertices - edges + faces) / 2);
}

Index count_manifold_tunnels(std::span<const Triangle> triangles) {
  Index last = -1;
  for (const auto& [a, b, c] : triangles) last = std::max({last, a, b, c});
  DisjointSets pieces(at(last + 1));
  std::vector<bool> is_used(at(last + 1), false);
  for (const auto& [a, b, c] : triangles) {
    pieces.join(a, b);
    pieces.join(a, c);
    is_used[at(a)] = is_used[at(b)] = is_used[at(c)] = true;
  }
  std::int64_t vertices = 0, count = 0;
  for (Index i = 0; i <= last; ++i) {
    if (!is_used[at(i)]) continue;
    ++vertices;
    count += pieces.root(i) == i ? 1 : 0;
  }
  const auto faces = static_cast<std::int64_t>(triangles.size());  // three edges each, shared by two
  return static_cast<Index>(count - (vertices - faces / 2) / 2);
}

}  // namespace softreel
