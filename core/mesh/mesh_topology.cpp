#include "core/mesh/mesh_topology.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace softreel {

std::vector<Triangle> welded_triangles(const SurfaceMesh& mesh) {
  return welded_triangles(mesh.triangles, weld_positions(mesh.positions));
}

std::vector<Triangle> welded_triangles(std::vector<Triangle> triangles, const std::vector<Index>& weld) {
  for (Triangle& triangle : triangles)
    for (Index& v : triangle) v = weld[static_cast<std::size_t>(v)];
  return triangles;
}

bool is_balanced(std::span<const HalfEdge> edge) {
  const auto forward = std::count_if(edge.begin(), edge.end(), [](const HalfEdge& side) { return side.forward; });
  return 2 * static_cast<std::size_t>(forward) == edge.size();
}

bool is_collapsed(const Triangle& welded) {
  return welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0];
}

std::vector<HalfEdge> sorted_half_edges(std::span<const Triangle> welded) {
  Index vertices = 0;
  for (const Triangle& t : welded) vertices = std::max({vertices, t[0] + 1, t[1] + 1, t[2] + 1});
  std::vector<std::size_t> begin(static_cast<std::size_t>(vertices) + 1, 0);  // counting sort by the lower vertex
  const auto for_sides = [&](const auto& body) {
    for (std::size_t t = 0; t < welded.size(); ++t) {
      if (is_collapsed(welded[t])) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index a = welded[t][k], b = welded[t][(k + 1) % 3];
        body(HalfEdge{std::min(a, b), std::max(a, b), static_cast<Index>(t), a < b});
      }
    }
  };
  for_sides([&](const HalfEdge& side) { ++begin[static_cast<std::size_t>(side.low) + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<HalfEdge> sides(begin.back());
  std::vector<std::size_t> at(begin.begin(), begin.end() - 1);
  for_sides([&](const HalfEdge& side) { sides[at[static_cast<std::size_t>(side.low)]++] = side; });
  for (std::size_t v = 0; v + 1 < begin.size(); ++v)
    std::sort(sides.begin() + static_cast<std::ptrdiff_t>(begin[v]),
              sides.begin() + static_cast<std::ptrdiff_t>(begin[v + 1]), [](const HalfEdge& a, const HalfEdge& b) {
                return std::tie(a.high, a.triangle) < std::tie(b.high, b.triangle);
              });
  return sides;
}

}  // namespace softreel
