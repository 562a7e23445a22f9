/// A tree of boxes over triangles: the nearest triangle to a point, and the frame of fast winding numbers.
#pragma once

#include <vector>

#include "core/base/types.h"

namespace softreel {

/// The point of a triangle that is nearest to `p` (Ericson, Real-Time Collision Detection, 2005, sec. 5.1.5).
Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Bounding-volume tree, built by halving triangles along the longest side of their centroids' box. The same input
/// gives the same tree. Reading is thread-safe.
class TriangleTree {
 public:
  /// A node covers triangles [begin, end) of `order()`. Its left child is the next node; `right` is 0 for leaves.
  struct Node {
    Vec3 min, max;
    Index begin, end, right;
    bool is_leaf() const { return right == 0; }
  };
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

  const std::vector<Node>& nodes() const { return nodes_; }
  /// Gives back the room of the nodes, for one who has what it needs of them: only order() and corners() remain.
  void drop_nodes() { std::vector<Node>().swap(nodes_); }
  /// Numbers of the triangles in the order of the leaves.
  const std::vector<Index>& order() const { return order_; }
  /// Corners of the triangle at a place in order().
  std::array<Vec3, 3> corners(Index place) const {
    const auto& [a, b, c] = triangles_[static_cast<std::size_t>(place)];
    return {points_[static_cast<std::size_t>(a)], points_[static_cast<std::size_t>(b)],
            points_[static_cast<std::size_t>(c)]};
  }

 private:
  /// What a tree is built from.
  struct Given {
    const std::vector<Vec3>& points;
    const std::vector<Triangle>& triangles;
    std::vector<Vec3> centroids;  ///< per triangle
  };
  void build(const Given& given, Index begin, Index end);
  void take_corners(const Given& given);
  template <typename Accept>
  Nearest search(const Vec3& p, Nearest best, double squared_enough, const Accept& accept) const;

  std::vector<Node> nodes_;
  std::vector<Index> order_;
  std::vector<Triangle> triangles_;  ///< in the order of the leaves, of points_
  std::vector<Vec3> points_;         ///< as the leaves first use them: neighbours are near in memory
};

/// Squared distance from a point to a box, 0 inside.
inline double squared_box_distance(const Vec3& p, const Vec3& min, const Vec3& max) {
  return (min - p).cwiseMax(p - max).cwiseMax(0.0).squaredNorm();
}

template <typename Accept>
TriangleTree::Nearest TriangleTree::nearest(const Vec3& p, double squared_limit, const Accept& accept) const {
  Nearest best;
  best.squared_distance = squared_limit;
  return search(p, best, -1, accept);
}

template <typename Accept>
TriangleTree::Nearest TriangleTree::search(const Vec3& p, Nearest best, double squared_enough,
                                           const Accept& accept) const {
  if (nodes_.empty()) return best;
  struct Entry {
    Index node;
    double squared_distance;
  };
  std::array<Entry, 64> stack;  // halving: depth at most 32
  std::size_t depth = 0;
  const auto box_distance = [&](Index n) {
    const Node& node = nodes_[static_cast<std::size_t>(n)];
    return squared_box_distance(p, node.min, node.max);
  };
  stack[depth++] = {0, box_distance(0)};
  while (depth > 0 && best.squared_distance > squared_enough) {
    const Entry entry = stack[--depth];
    if (entry.squared_distance > best.squared_distance) continue;
    const Node& node = nodes_[static_cast<std::size_t>(entry.node)];
    if (!node.is_leaf()) {
      Entry near{entry.node + 1, box_distance(entry.node + 1)}, far{node.right, box_distance(node.right)};
      if (far.squared_distance < near.squared_distance) std::swap(near, far);
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    for (Index i = node.begin; i < node.end; ++i) {
      const auto& [a, b, c] = corners(i);
      const Vec3 point = nearest_on_triangle(p, a, b, c);
      const double d = (point - p).squaredNorm();
      const Index triangle = order_[static_cast<std::size_t>(i)];
      if (d > best.squared_distance || (d == best.squared_distance && best.triangle >= 0 && triangle > best.triangle))
        continue;
      if (accept(triangle, point)) best = {triangle, d, point, i};
    }
  }
  return best;
}

}  // namespace softreel
