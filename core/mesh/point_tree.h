/// Nearest of a set of points: a balanced k-d tree in an array (Bentley 1975).
#pragma once

#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Holds a copy of the points. Queries are thread-safe.
class PointTree {
 public:
  /// Cost: n log n. Points that are not finite must not be among them.
  explicit PointTree(std::vector<Vec3> points);

  /// Index (in the order given) of the point nearest to q, of several the lowest; -1 of no points. Cost: about log n.
  Index nearest(const Vec3& q) const;

  /// The `count` nearest points, or all if there are fewer; nearer ones first, of equally near ones the lower number.
  /// Cost: about log n, and count log(count).
  std::vector<Index> nearest(const Vec3& q, std::size_t count) const;

  /// Calls visit(index) for each point whose coordinates all are within `reach` of q's. Cost: about log n and the
  /// number of points in that cube.
  template <typename Visit>
  void visit_near(const Vec3& q, double reach, const Visit& visit) const {
    visit_near(0, order_.size(), 0, q, reach, visit);
  }

 private:
  struct Best {
    double squared_distance;
    Index index;
    bool operator<(const Best& other) const {
      return squared_distance != other.squared_distance ? squared_distance < other.squared_distance
                                                        : index < other.index;
    }
  };
  void build(std::size_t begin, std::size_t end, int axis);
  void search(std::size_t begin, std::size_t end, int axis, const Vec3& q, Best& best) const;
  /// best: a heap of at most `count`, the farthest on top.
  void search(std::size_t begin, std::size_t end, int axis, const Vec3& q, std::size_t count,
              std::vector<Best>& best) const;

  template <typename Visit>
  void visit_near(std::size_t begin, std::size_t end, int axis, const Vec3& q, double reach, const Visit& visit) const {
    if (begin >= end) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const Vec3 d = points_[static_cast<std::size_t>(order_[middle])] - q;
    if (d.cwiseAbs().maxCoeff() <= reach) visit(order_[middle]);
    if (d[axis] >= -reach) visit_near(begin, middle, (axis + 1) % 3, q, reach, visit);
    if (d[axis] <= reach) visit_near(middle + 1, end, (axis + 1) % 3, q, reach, visit);
  }

  std::vector<Vec3> points_;
  std::vector<Index> order_;  ///< the middle of a range is its root; its axis is the depth modulo 3
};

}  // namespace softreel
