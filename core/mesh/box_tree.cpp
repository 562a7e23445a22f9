#include "core/mesh/box_tree.h"

#include <algorithm>
#include <numeric>

namespace softreel {

BoxTree::BoxTree(const std::vector<Bounds>& boxes) {
  if (boxes.empty()) return;
  std::vector<Index> order(boxes.size());
  std::iota(order.begin(), order.end(), 0);
  nodes_.reserve(2 * boxes.size());
  build(boxes, order, 0, boxes.size());
}

/// Halves at the median of the centres along the longest side of the box.
Index BoxTree::build(const std::vector<Bounds>& boxes, std::vector<Index>& order, std::size_t begin, std::size_t end) {
  const auto number = static_cast<Index>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.first = *std::min_element(order.begin() + static_cast<std::ptrdiff_t>(begin),
                                 order.begin() + static_cast<std::ptrdiff_t>(end));
  node.last = *std::max_element(order.begin() + static_cast<std::ptrdiff_t>(begin),
                                order.begin() + static_cast<std::ptrdiff_t>(end));
  Bounds centers;
  for (std::size_t i = begin; i < end; ++i) {
    const Bounds& box = boxes[static_cast<std::size_t>(order[i])];
    node.box.min = node.box.min.cwiseMin(box.min);
    node.box.max = node.box.max.cwiseMax(box.max);
    centers.add(box.center());
  }
  if (end - begin > 1) {
    Index axis = 0;
    centers.size().maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](Index a, Index b) {
      const double p = boxes[static_cast<std::size_t>(a)].center()[axis];
      const double q = boxes[static_cast<std::size_t>(b)].center()[axis];
      return p != q ? p < q : a < b;
    });
    build(boxes, order, begin, middle);
    node.right = build(boxes, order, middle, end);
  }
  nodes_[static_cast<std::size_t>(number)] = node;
  return number;
}

}  // namespace softreel
