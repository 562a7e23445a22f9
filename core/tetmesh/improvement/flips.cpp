#include "core/tetmesh/improvement/flips.h"

#include <algorithm>
#include <limits>

namespace softreel {

double Flips::worst(std::span<const Index> elements) const {
  double quality = std::numeric_limits<double>::max();
  for (const Index e : elements) quality = std::min(quality, tets_.quality(e));
  return quality;
}

/// The best choice between all pairs of ring nodes, short parts first. What is not better than `limit` is not followed.
void Flips::fill_table(Index a, Index b, double limit) {
  const std::size_t n = ring_.nodes.size();
  for (std::size_t i = 0; i + 1 < n; ++i) table_[i][i + 1] = {std::numeric_limits<double>::max(), i};
  for (std::size_t length = 2; length < n; ++length)
    for (std::size_t i = 0; i + length < n; ++i) {
      const std::size_t k = i + length;
      Choice best{AngleMeasure::kFlat, i};
      for (std::size_t j = i + 1; j < k; ++j) {
        double quality = std::min(table_[i][j].quality, table_[j][k].quality);
        if (quality <= std::max(best.quality, limit)) continue;
        const Index p = ring_node(i), q = ring_node(j), r = ring_node(k);
        quality = std::min(quality, tets_.measure().new_quality(tets_.corners(Tet{p, q, r, b})));
        if (quality <= std::max(best.quality, limit)) continue;
        quality = std::min(quality, tets_.measure().new_quality(tets_.corners(Tet{p, r, q, a})));
        if (quality > best.quality) best = {quality, j};
      }
      table_[i][k] = best;
    }
}

/// The elements of the choice between two nodes of the ring.
void Flips::list_triangles(std::size_t first, std::size_t last, Index a, Index b) {
  if (last < first + 2) return;
  const std::size_t middle = table_[first][last].middle;
  const Index p = ring_node(first), q = ring_node(middle), r = ring_node(last);
  found_.push_back({p, q, r, b});
  found_.push_back({p, r, q, a});
  list_triangles(first, middle, a, b);
  list_triangles(middle, last, a, b);
}

/// True if an edge or a lone face of the new elements is there already, on the other side of the ring: only where a
/// mesh overlaps itself.
bool Flips::has_diagonal() const {
  const auto& nodes = ring_.nodes;
  if (nodes.size() == 3) return tets_.across({nodes[0], nodes[1], nodes[2]}, -1) != -1;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t k = i + 2; k < nodes.size() - (i == 0 ? 1 : 0); ++k)
      if (std::ranges::any_of(found_,
                              [&](const Tet& tet) {
                                return std::ranges::count(tet, nodes[i]) + std::ranges::count(tet, nodes[k]) == 2;
                              }) &&
          tets_.has_edge(nodes[i], nodes[k]))
        return true;
  return false;
}

bool Flips::remove_edge(Index a, Index b) {
  tets_.find_ring(a, b, ring_);
  const std::size_t n = ring_.nodes.size();
  if (!ring_.closed || n > kLargestRing) return false;
  const double limit = worthwhile(worst(ring_.elements));
  fill_table(a, b, limit);
  if (table_[0][n - 1].quality <= limit) return false;
  found_.clear();
  list_triangles(0, n - 1, a, b);
  if (has_diagonal()) return false;
  tets_.exchange(ring_.elements, found_);
  return true;
}

bool Flips::remove_face(Index element, Index apex) {
  Triangle face;
  std::size_t count = 0;
  for (const Index node : tets_.tet(element))
    if (node != apex) face[count++] = node;
  const Index other = tets_.across(face, element);
  if (other < 0) return false;
  Index far = -1;
  for (const Index node : tets_.tet(other))
    if (std::ranges::count(face, node) == 0) far = node;
  if (far == apex || tets_.has_edge(apex, far)) return false;
  const Vec3& p = tets_.position(face[0]);
  if ((tets_.position(face[1]) - p).cross(tets_.position(face[2]) - p).dot(tets_.position(apex) - p) < 0)
    std::swap(face[1], face[2]);
  const std::array<Index, 2> old{element, other};
  const double limit = worthwhile(worst(old));
  found_.clear();
  for (std::size_t k = 0; k < 3; ++k) {
    found_.push_back({far, apex, face[k], face[(k + 1) % 3]});
    if (tets_.measure().new_quality(tets_.corners(found_.back())) <= limit) return false;
  }
  tets_.exchange(old, found_);
  return true;
}

}  // namespace softreel
