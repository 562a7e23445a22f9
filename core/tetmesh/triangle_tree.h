/// A tree of boxes over triangles, for the nearest one to a point.
#pragma once

#include <algorithm>
#include <cfloat>
#include <vector>

#include "core/base/types.h"
#include "core/mesh/ordered_triangles.h"

namespace softreel {

/// The point of a triangle that is nearest to `p` (Ericson, Real-Time Collision Detection, 2005, sec. 5.1.5).
Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Bounding-volume tree with eight children a node, whose leaves are single triangles. It is packed: the children of a
/// node follow one another, all nodes but the last of a level are full, and no link is stored. Built by halving
/// triangles along the longest side of their centroids' box. The same input gives the same tree. Reading is
/// thread-safe.
///
/// Boxes have single precision, about the middle of all and rounded outwards, so that what is nearest is found with all
/// bits; 27 bytes a triangle. Corners must be finite; a point that is not finds none.
class TriangleTree {
 public:
  struct Nearest {
    Index triangle = -1;  ///< -1: none accepted
    double squared_distance = 1e300;
    Vec3 point = Vec3::Zero();
    Index place = -1;  ///< of the triangle in order()
  };

  /// Copies what it needs. An empty list is allowed.
  TriangleTree(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  /// Nearest triangle nearer than sqrt(squared_limit) for which accept(triangle, nearest point) holds; ties go to the
  /// lowest number.
  template <typename Accept>
  Nearest nearest(const Vec3& p, double squared_limit, const Accept& accept) const;
  Nearest nearest(const Vec3& p) const {
    return nearest(p, 1e300, [](Index, const Vec3&) { return true; });
  }

  /// The same, quicker from a guess: the place in order() of a triangle that may be near, -1 for none. Of triangles
  /// nearer than sqrt(squared_enough) the first one met will do; there may be none within sqrt(squared_limit).
  Nearest nearest_from(const Vec3& p, Index place, double squared_enough = -1, double squared_limit = 1e300) const;

  /// Calls visit(place) for triangles whose box meets(min, max); these boxes may be larger by rounding, or
  /// smaller by a last bit.
  template <typename Meets, typename Visit>
  void visit(const Meets& meets, const Visit& visit) const;

  bool empty() const { return nodes_.empty(); }
  /// Numbers of the triangles in the order of the leaves.
  const std::vector<Index>& order() const { return triangles_.order(); }
  /// Corners of the triangle at a place in order().
  std::array<Vec3, 3> corners(Index place) const { return triangles_.corners(place); }

 private:
  static constexpr Index kWidth = 8;
  using Lanes = Eigen::Array<float, kWidth, 1>;

  /// The boxes of eight children; of missing ones min is +infinity and max is -infinity.
  struct Node {
    std::array<Lanes, 3> min, max;
  };
  /// A node, by its level and its number in there; of level -1, a triangle by its place.
  struct Entry {
    float squared_distance;
    std::int32_t level;
    Index number;
  };
  /// Triangles halve three times a level; of each level all but one of the children wait.
  static constexpr std::size_t kMostOpen = 11 * (kWidth - 1) + 1;

  /// Between these lies a point.
  struct Query {
    std::array<float, 3> low, high;
  };

  static void order_node(TriangleSorter& sorter, Index begin, Index end);
  static void order_children(TriangleSorter& sorter, Index begin, Index end, Index child_size);
  void find_boxes();

  const Node& node_of(const Entry& entry) const { return nodes_[level_begins_[at(entry.level)] + at(entry.number)]; }
  Entry root() const { return {0, static_cast<std::int32_t>(level_begins_.size()) - 1, 0}; }
  Query query_of(const Vec3& p) const;
  static Lanes squared_distances(const Node& node, const Query& query);
  /// What a box that holds a nearer point is at most away, as boxes measure it.
  static float reach_of(double squared_distance) {
    return static_cast<float>(std::min(squared_distance, 1e38)) * (1 + 2e-6f) + FLT_MIN;
  }
  template <typename Accept>
  Nearest search(const Vec3& p, Nearest best, double squared_enough, const Accept& accept) const;
  template <typename Accept>
  void try_triangle(const Vec3& p, Index place, Nearest& best, const Accept& accept) const;

  Vec3 middle_ = Vec3::Zero();
  std::vector<Node> nodes_;                ///< level by level, the root last
  std::vector<std::size_t> level_begins_;  ///< per level: its first node
  OrderedTriangles triangles_;
};

inline TriangleTree::Lanes TriangleTree::squared_distances(const Node& node, const Query& query) {
  Lanes sum = Lanes::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes gap = (node.min[k] - query.high[k]).max(query.low[k] - node.max[k]).max(0.0f);
    sum += gap * gap;
  }
  return sum;
}

template <typename Accept>
TriangleTree::Nearest TriangleTree::nearest(const Vec3& p, double squared_limit, const Accept& accept) const {
  Nearest best;
  best.squared_distance = squared_limit;
  return search(p, best, -1, accept);
}

template <typename Accept>
void TriangleTree::try_triangle(const Vec3& p, Index place, Nearest& best, const Accept& accept) const {
  const auto& [a, b, c] = corners(place);
  const Vec3 point = nearest_on_triangle(p, a, b, c);
  const double squared = (point - p).squaredNorm();
  if (squared > best.squared_distance) return;
  const Index triangle = order()[at(place)];
  if (squared == best.squared_distance && best.triangle >= 0 && triangle > best.triangle) return;
  if (accept(triangle, point)) best = {triangle, squared, point, place};
}

template <typename Accept>
TriangleTree::Nearest TriangleTree::search(const Vec3& p, Nearest best, double squared_enough,
                                           const Accept& accept) const {
  if (nodes_.empty()) return best;
  const Query query = query_of(p);
  std::array<Entry, kMostOpen> open;
  std::size_t count = 0;
  open[count++] = root();
  while (count > 0 && best.squared_distance > squared_enough) {
    const Entry entry = open[--count];
    float reach = reach_of(best.squared_distance);
    if (!(entry.squared_distance <= reach)) continue;  // not a number: a point that is not finite finds none
    alignas(32) std::array<float, kWidth> distances;
    Eigen::Map<Lanes, Eigen::AlignedMax>(distances.data()) = squared_distances(node_of(entry), query);
    // The farthest first, so that the nearest is taken next.
    const std::size_t first = count;
    for (Index k = 0; k < kWidth; ++k) {
      if (!(distances[at(k)] <= reach)) continue;
      std::size_t place = count++;
      for (; place > first && open[place - 1].squared_distance < distances[at(k)]; --place)
        open[place] = open[place - 1];
      open[place] = {distances[at(k)], entry.level - 1, kWidth * entry.number + k};
    }
    if (entry.level > 0) continue;
    for (; count > first; --count)
      if (open[count - 1].squared_distance <= reach) {
        try_triangle(p, open[count - 1].number, best, accept);
        reach = reach_of(best.squared_distance);
      }
    count = first;
  }
  return best;
}

template <typename Meets, typename Visit>
void TriangleTree::visit(const Meets& meets, const Visit& visit) const {
  if (nodes_.empty()) return;
  std::array<Entry, kMostOpen> open;
  std::size_t count = 0;
  open[count++] = root();
  while (count > 0) {
    const Entry entry = open[--count];
    const Node& node = node_of(entry);
    for (Index k = kWidth; k-- > 0;) {
      const Vec3 min(node.min[0][k], node.min[1][k], node.min[2][k]),
          max(node.max[0][k], node.max[1][k], node.max[2][k]);
      if (min[0] > max[0] || !meets(Vec3(middle_ + min), Vec3(middle_ + max))) continue;
      const Index number = kWidth * entry.number + k;
      if (entry.level > 0)
        open[count++] = {0, entry.level - 1, number};
      else
        visit(number);
    }
  }
}

}  // namespace softreel
