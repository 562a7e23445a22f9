#include "core/dynamics/pieces.h"

#include <algorithm>
#include <numeric>

namespace softreel {
namespace {

Index find_root(std::vector<Index>& parent, Index i) {
  while (parent[static_cast<std::size_t>(i)] != i) {
    Index& up = parent[static_cast<std::size_t>(i)];
    up = parent[static_cast<std::size_t>(up)];
    i = up;
  }
  return i;
}

}  // namespace

Pieces find_pieces(const std::vector<Tet>& tets, std::size_t nodes, std::span<const std::uint8_t> members) {
  const auto belongs = [&](Index node) { return members.empty() || members[static_cast<std::size_t>(node)] != 0; };
  std::vector<Index> parent(nodes);
  std::iota(parent.begin(), parent.end(), 0);
  for (const Tet& tet : tets) {
    const auto first = std::find_if(tet.begin(), tet.end(), belongs);
    for (auto node = first; node != tet.end(); ++node) {
      if (!belongs(*node)) continue;
      const Index a = find_root(parent, *first), b = find_root(parent, *node);
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  Pieces pieces{0, std::vector<Index>(nodes, -1)};
  for (std::size_t i = 0; i < nodes; ++i) {
    if (!belongs(static_cast<Index>(i))) continue;
    const auto root = static_cast<std::size_t>(find_root(parent, static_cast<Index>(i)));
    pieces.of_node[i] = root == i ? pieces.count++ : pieces.of_node[root];
  }
  return pieces;
}

}  // namespace softreel
