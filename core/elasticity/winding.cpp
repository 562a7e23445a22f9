#include "core/elasticity/winding.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softreel {
namespace {

/// Whole turns to tell apart: 1 about an interior edge at rest, 2 where it is wound twice. Sums of angles are exact to
/// round-off, so any value between does; a boundary edge, which is not closed, has less than one turn at rest.
constexpr double kOneTurn = 1 - 1e-6;
constexpr double kWound = 1.5;

/// Calls visit(element, position of a in it, position of b in it) for the elements that have both nodes.
template <typename Visit>
void for_ring(const ElasticBody& body, Index a, Index b, const Visit& visit) {
  const NodeElements& at = body.node_elements;
  for (std::int64_t k = at.offsets[static_cast<std::size_t>(a)]; k < at.offsets[static_cast<std::size_t>(a) + 1]; ++k) {
    const std::uint32_t entry = at.entries[static_cast<std::size_t>(k)];
    const Tet& tet = body.tets[entry / 4];
    const auto found = std::find(tet.begin(), tet.end(), b);
    if (found != tet.end())
      visit(static_cast<Index>(entry / 4), static_cast<int>(entry % 4), static_cast<int>(found - tet.begin()));
  }
}

/// The two other corners of a positive tetrahedron, counter-clockwise as seen against the edge from corner a to b.
std::pair<int, int> others(int a, int b) {
  constexpr int kOthers[4][4][2] = {{{0, 0}, {2, 3}, {3, 1}, {1, 2}},
                                    {{3, 2}, {0, 0}, {0, 3}, {2, 0}},
                                    {{1, 3}, {3, 0}, {0, 0}, {0, 1}},
                                    {{2, 1}, {0, 2}, {1, 0}, {0, 0}}};
  return {kOthers[a][b][0], kOthers[a][b][1]};
}

using Edge = std::pair<Index, Index>;

std::vector<Edge> edges_of(const ElasticBody& body, std::span<const Index> elements) {
  std::vector<Edge> edges;
  edges.reserve(6 * elements.size());
  for (const Index e : elements) {
    const Tet& tet = body.tets[static_cast<std::size_t>(e)];
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) edges.push_back(std::minmax(tet[i], tet[j]));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace

double edge_turns(const ElasticBody& body, Index a, Index b, std::span<const Vec3> positions) {
  const Vec3& start = positions[static_cast<std::size_t>(a)];
  const Vec3 axis = (positions[static_cast<std::size_t>(b)] - start).normalized();
  if (!(axis.squaredNorm() > 0.5)) return 0;
  double angle = 0;
  for_ring(body, a, b, [&](Index e, int at_a, int at_b) {
    const Tet& tet = body.tets[static_cast<std::size_t>(e)];
    const auto [c, d] = others(at_a, at_b);
    const auto across = [&](int corner) -> Vec3 {
      const Vec3 arm = positions[static_cast<std::size_t>(tet[static_cast<std::size_t>(corner)])] - start;
      return arm - axis.dot(arm) * axis;
    };
    const Vec3 first = across(c), second = across(d);
    angle += std::atan2(axis.dot(first.cross(second)), first.dot(second));
  });
  return angle / (2 * EIGEN_PI);
}

std::vector<Index> find_wound_elements(const ElasticBody& body, std::span<const Vec3> positions,
                                       std::span<const Index> suspects) {
  std::vector<Index> wound;
  for (const auto& [a, b] : edges_of(body, suspects)) {
    if (edge_turns(body, a, b, positions) < kWound) continue;
    if (edge_turns(body, a, b, body.rest_positions) < kOneTurn) continue;
    for_ring(body, a, b, [&](Index e, int, int) { wound.push_back(e); });
  }
  std::sort(wound.begin(), wound.end());
  wound.erase(std::unique(wound.begin(), wound.end()), wound.end());
  return wound;
}

}  // namespace softreel
