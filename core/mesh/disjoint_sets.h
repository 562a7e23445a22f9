/// Union-find: which things are joined, directly or through others.
#pragma once

#include <numeric>
#include <utility>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Sets of the numbers 0 .. n-1. The root of a set is its smallest number, whatever the order of joining.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parents_(n) { std::iota(parents_.begin(), parents_.end(), 0); }

  Index root(Index i) {
    while (parent(i) != i) {
      parent(i) = parent(parent(i));
      i = parent(i);
    }
    return i;
  }

  void join(Index a, Index b) {
    a = root(a);
    b = root(b);
    if (a > b) std::swap(a, b);
    parent(b) = a;
  }

 private:
  Index& parent(Index i) { return parents_[static_cast<std::size_t>(i)]; }

  std::vector<Index> parents_;
};

}  // namespace softreel
