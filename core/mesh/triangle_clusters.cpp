#include "core/mesh/triangle_clusters.h"

namespace softreel {
namespace {

constexpr Index kLeafSize = 4;

/// Of a tree over so many triangles.
std::size_t count_nodes(Index triangles) {
  return triangles <= kLeafSize ? 1 : 1 + count_nodes(triangles / 2) + count_nodes(triangles - triangles / 2);
}

}  // namespace

TriangleClusters::TriangleClusters(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  if (triangles.empty()) return;
  nodes_.reserve(count_nodes(static_cast<Index>(triangles.size())));
  TriangleSorter sorter(points, triangles);
  build(sorter, 0, static_cast<Index>(triangles.size()));
  triangles_ = OrderedTriangles(points, triangles, sorter.take_order());
  find_boxes();
}

/// Number of the node over [begin, end).
Index TriangleClusters::build(TriangleSorter& sorter, Index begin, Index end) {
  const auto number = static_cast<Index>(nodes_.size());
  nodes_.push_back({Vec3::Constant(1e300), Vec3::Constant(-1e300), begin, end, 0});
  if (end - begin <= kLeafSize) return number;
  const Index middle = begin + (end - begin) / 2;
  sorter.split(begin, middle, end);
  build(sorter, begin, middle);
  nodes_[at(number)].right = build(sorter, middle, end);
  return number;
}

void TriangleClusters::find_boxes() {
  for (std::size_t n = nodes_.size(); n-- > 0;) {  // children come after their parents
    Node& node = nodes_[n];
    if (node.is_leaf()) {
      for (Index i = node.begin; i < node.end; ++i)
        for (const Vec3& corner : corners(i)) {
          node.min = node.min.cwiseMin(corner);
          node.max = node.max.cwiseMax(corner);
        }
      continue;
    }
    const Node &left = nodes_[n + 1], &right = nodes_[at(node.right)];
    node.min = left.min.cwiseMin(right.min);
    node.max = left.max.cwiseMax(right.max);
  }
}

}  // namespace softreel
