/// A binary tree of clusters of triangles: what crosses what, and the frame of fast winding numbers.
#pragma once

#include <array>
#include <vector>

#include "core/base/types.h"
#include "core/mesh/ordered_triangles.h"

namespace softreel {

/// Built by halving triangles along the longest side of their centroids' box. The same input gives the same tree.
/// Reading is thread-safe.
class TriangleClusters {
 public:
  /// A node covers triangles [begin, end) of `order()`. Its left child is the next node; `right` is 0 for leaves.
  struct Node {
    Vec3 min, max;
    Index begin, end, right;
    bool is_leaf() const { return right == 0; }
  };

  /// Copies what it needs. An empty list is allowed, and has no nodes.
  TriangleClusters(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  const std::vector<Node>& nodes() const { return nodes_; }
  /// Gives back the room of the nodes, for one who has what it needs of them: only order() and corners() remain.
  void drop_nodes() { std::vector<Node>().swap(nodes_); }
  const std::vector<Index>& order() const { return triangles_.order(); }
  /// Corners of the triangle at a place in order().
  std::array<Vec3, 3> corners(Index place) const { return triangles_.corners(place); }

 private:
  Index build(TriangleSorter& sorter, Index begin, Index end);
  void find_boxes();

  std::vector<Node> nodes_;
  OrderedTriangles triangles_;
};

}  // namespace softreel
