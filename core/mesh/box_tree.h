/// Boxes in a binary tree: which of many lie near one, or around it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <queue>
#include <utility>
#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Queries are thread-safe.
class BoxTree {
 public:
  /// Cost: n log n.
  explicit BoxTree(const std::vector<Bounds>& boxes);

  /// Calls visit(number) for each box within `reach` of one, along every axis.
  template <typename Visit>
  void visit_near(const Bounds& box, double reach, const Visit& visit) const {
    std::vector<Index> open;
    if (!nodes_.empty()) open.push_back(0);
    while (!open.empty()) {
      const Node& node = nodes_[static_cast<std::size_t>(open.back())];
      const Index n = open.back();
      open.pop_back();
      if (!is_near(node.box, box, reach)) continue;
      if (node.right >= 0) {
        open.push_back(node.right);
        open.push_back(n + 1);
      } else {
        visit(node.last);
      }
    }
  }

  /// The last box below `end` that contains one and that is_it(number) accepts; -1 if there is none. Boxes are asked in
  /// falling order, so that none before the answer is.
  template <typename IsIt>
  Index find_last_around(const Bounds& box, Index end, const IsIt& is_it) const {
    std::priority_queue<std::pair<Index, Index>> open;  // the last box that a node may hold, and the node
    const auto push = [&](Index n) {
      const Node& node = nodes_[static_cast<std::size_t>(n)];
      if (node.first < end && contains(node.box, box)) open.emplace(std::min(node.last, end - 1), n);
    };
    if (!nodes_.empty()) push(0);
    while (!open.empty()) {
      const Index n = open.top().second;
      open.pop();
      const Node& node = nodes_[static_cast<std::size_t>(n)];
      if (node.right >= 0) {
        push(n + 1);
        push(node.right);
      } else if (is_it(node.last)) {
        return node.last;
      }
    }
    return -1;
  }

  static bool contains(const Bounds& outer, const Bounds& inner) {
    return (outer.min.array() <= inner.min.array()).all() && (outer.max.array() >= inner.max.array()).all();
  }
  static bool is_near(const Bounds& a, const Bounds& b, double reach) {
    return ((a.min.array() <= b.max.array() + reach) && (b.min.array() <= a.max.array() + reach)).all();
  }

 private:
  struct Node {
    Bounds box;
    Index first = 0, last = 0;  ///< least and greatest number of the boxes below
    Index right = -1;           ///< the left child follows its parent; -1: a leaf, one box
  };
  Index build(const std::vector<Bounds>& boxes, std::vector<Index>& order, std::size_t begin, std::size_t end);

  std::vector<Node> nodes_;
};

}  // namespace softreel
