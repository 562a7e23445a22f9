/// Boxes in a binary tree: which of many lie near one, or around it.
#pragma once

#include <algorithm>
#include <array>
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
  void visit_near(const Bounds& box, double reach, const Visit& visit_box) const {
    visit([&](const Bounds& other) { return is_near(other, box, reach); }, visit_box);
  }

  /// Calls visit_box(number) for each box that meets(box); this must hold for what contains one for which it holds. It
  /// may come to hold for fewer boxes on the way.
  template <typename Meets, typename Visit>
  void visit(const Meets& meets, const Visit& visit_box) const {
    std::array<Index, kMostOpen> open;
    std::size_t count = 0;
    if (!nodes_.empty()) open[count++] = 0;
    while (count > 0) {
      const Index n = open[--count];
      const Node& node = nodes_[static_cast<std::size_t>(n)];
      if (!meets(node.box)) continue;
      if (node.right >= 0) {
        open[count++] = node.right;
        open[count++] = n + 1;
      } else {
        visit_box(node.last);
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
  /// Of each level one child waits; a tree of 2^31 boxes has 31 levels.
  static constexpr std::size_t kMostOpen = 64;

  Index build(const std::vector<Bounds>& boxes, std::vector<Index>& order, std::size_t begin, std::size_t end);

  std::vector<Node> nodes_;
};

}  // namespace softreel
