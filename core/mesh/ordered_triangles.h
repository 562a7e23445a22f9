/// Triangles in the order of a tree's leaves, with the corners that they need.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Orders triangles by where their centroids are, range by range. The same input gives the same order.
class TriangleSorter {
 public:
  TriangleSorter(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  /// Of the triangles at [begin, end), those before `middle` come to lie before the others along the longest side of
  /// their centroids' box.
  void split(Index begin, Index middle, Index end);

  /// The order; frees the rest.
  std::vector<Index> take_order() {
    std::vector<Vec3>().swap(centroids_);
    return std::move(order_);
  }

 private:
  std::vector<Vec3> centroids_;  ///< per triangle
  std::vector<Index> order_;     ///< numbers of the triangles
};

/// Copies of triangles and their corners, near in memory where they are near in the order. Reading is thread-safe.
class OrderedTriangles {
 public:
  OrderedTriangles() = default;
  OrderedTriangles(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, std::vector<Index> order);

  /// Numbers of the triangles.
  const std::vector<Index>& order() const { return order_; }
  /// Corners of the triangle at a place in order().
  std::array<Vec3, 3> corners(Index place) const {
    const auto& [a, b, c] = triangles_[at(place)];
    return {points_[at(a)], points_[at(b)], points_[at(c)]};
  }

 private:
  std::vector<Index> order_;
  std::vector<Triangle> triangles_;  ///< in that order, of points_
  std::vector<Vec3> points_;         ///< in the order in which triangles first use them
};

}  // namespace softreel
