/// A tree of boxes over triangles, for the nearest one to a point.
#pragma once

#include <algorithm>
#include <bit>
#include <cfloat>
#include <vector>

#include "core/base/types.h"
#include "core/mesh/ordered_triangles.h"
#include "core/tetmesh/lane_mask_simd.h"

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
  /// What waits: the bits of its squared distance, which are in order as the distances are, above a node, which is its
  /// level above its number in there, or above the place of a triangle.
  using Entry = std::uint64_t;
  static constexpr int kNumberBits = 28;
  static constexpr std::uint32_t kNumberMask = (1u << kNumberBits) - 1;
  static constexpr Entry kDistanceMask = Entry{0xffffffff} << 32;

  static Entry entry_of(float squared_distance, std::uint32_t what) {
    return Entry{std::bit_cast<std::uint32_t>(squared_distance)} << 32 | what;
  }
  static float distance_of(Entry entry) { return std::bit_cast<float>(static_cast<std::uint32_t>(entry >> 32)); }
  static std::uint32_t level_of(Entry entry) { return static_cast<std::uint32_t>(entry) >> kNumberBits; }
  /// The first child of a node, without its distance.
  static std::uint32_t first_child(Entry entry) {
    const std::uint32_t number = kWidth * (static_cast<std::uint32_t>(entry) & kNumberMask), level = level_of(entry);
    return level > 0 ? (level - 1) << kNumberBits | number : number;
  }
  /// Triangles halve three times a level; of each level all but one of the children wait.
  static constexpr std::size_t kMostOpen = 11 * (kWidth - 1) + 1;

  /// Between these lies a point.
  struct Query {
    std::array<float, 3> low, high;
  };

  static void order_node(TriangleSorter& sorter, Index begin, Index end);
  static void order_children(TriangleSorter& sorter, Index begin, Index end, Index child_size);
  void find_boxes();

  const Node& node_of(Entry entry) const {
    return nodes_[level_begins_[level_of(entry)] + (static_cast<std::uint32_t>(entry) & kNumberMask)];
  }
  Entry root() const { return (level_begins_.size() - 1) << kNumberBits; }
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
    if (!(distance_of(entry) <= reach)) continue;  // not a number: a point that is not finite finds none
    alignas(32) std::array<float, kWidth> distances;
    Eigen::Map<Lanes, Eigen::AlignedMax>(distances.data()) = squared_distances(node_of(entry), query);
    // The farthest first, so that the nearest is taken next.
    const std::size_t first = count;
    const std::uint32_t child = first_child(entry);
    for (unsigned hits = lanes_within(distances.data(), reach); hits != 0; hits &= hits - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(hits));
      const Entry next = entry_of(distances[k], child + k);
      std::size_t place = count++;
      for (; place > first && open[place - 1] < (next & kDistanceMask); --place) open[place] = open[place - 1];
      open[place] = next;
    }
    if (level_of(entry) > 0) continue;
    for (; count > first; --count)
      if (distance_of(open[count - 1]) <= reach) {
        try_triangle(p, static_cast<Index>(static_cast<std::uint32_t>(open[count - 1])), best, accept);
        reach = reach_of(best.squared_distance);
      }
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
    for (std::uint32_t k = kWidth; k-- > 0;) {
      const Vec3 min(node.min[0][k], node.min[1][k], node.min[2][k]),
          max(node.max[0][k], node.max[1][k], node.max[2][k]);
      if (min[0] > max[0] || !meets(Vec3(middle_ + min), Vec3(middle_ + max))) continue;
      const std::uint32_t child = first_child(entry) + k;
      if (level_of(entry) > 0)
        open[count++] = child;
      else
        visit(static_cast<Index>(child));
    }
  }
}

}  // namespace softreel
