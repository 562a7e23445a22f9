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

 private:
  struct Best {
    double squared_distance;
    Index index;
  };
  void build(std::size_t begin, std::size_t end, int axis);
  void search(std::size_t begin, std::size_t end, int axis, const Vec3& q, Best& best) const;

  std::vector<Vec3> points_;
  std::vector<Index> order_;  ///< the middle of a range is its root; its axis is the depth modulo 3
};

}  // namespace softreel
