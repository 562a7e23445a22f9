/// Sparse sets of BCC lattice nodes, numbered along a space-filling curve, and the neighbours of a node.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/number_table.h"
#include "core/base/types.h"
#include "core/tetmesh/lattice/bcc_lattice.h"

namespace softreel {

/// A node has 6 neighbours along long edges (-x, +x, -y, +y, -z, +z) and, after them, 8 along short edges
/// (6 + 1 if +x, + 2 if +y, + 4 if +z).
constexpr std::size_t kLongNeighbors = 6, kNeighbors = 14;
extern const std::array<LatticeNode, kNeighbors> kNeighborOffsets;

/// The neighbour in direction `k`.
inline LatticeNode lattice_neighbor(const LatticeNode& node, std::size_t k) {
  const LatticeNode& d = kNeighborOffsets[k];
  return {node[0] + d[0], node[1] + d[1], node[2] + d[2]};
}

/// Direction from a node to its neighbour; the inverse of lattice_neighbor.
inline std::size_t neighbor_direction(const LatticeNode& from, const LatticeNode& to) {
  const std::int32_t x = to[0] - from[0], y = to[1] - from[1], z = to[2] - from[2];
  if ((x & 1) != 0)
    return kLongNeighbors + static_cast<std::size_t>(x > 0) + 2 * static_cast<std::size_t>(y > 0) +
           4 * static_cast<std::size_t>(z > 0);
  if (x != 0) return static_cast<std::size_t>(x > 0);
  return y != 0 ? 2 + static_cast<std::size_t>(y > 0) : 4 + static_cast<std::size_t>(z > 0);
}

/// Colour 0..3 of a node: sublattice and parity of the sum of its halved coordinates. Neighbours differ in colour.
inline int lattice_color(const LatticeNode& node) {
  return 2 * (node[0] & 1) + (((node[0] >> 1) + (node[1] >> 1) + (node[2] >> 1)) & 1);
}

/// Largest absolute coordinate of a node in a LatticeNodeSet.
constexpr std::int32_t kMaxLatticeCoordinate = (1 << 20) - 8;

/// A set of lattice nodes in blocks of 4 x 4 x 4 cubic cells, a bit per node. Once numbered, its nodes are 0, 1, 2 ...
/// along a Morton curve: near in space is near in memory.
class LatticeNodeSet {
 public:
  /// Adds a node; false if it was there. Takes the numbers away.
  bool insert(const LatticeNode& node);
  bool contains(const LatticeNode& node) const;

  /// Numbers all nodes, and gives back room that was kept for more. Cost: a sort of the blocks.
  void number_nodes();

  /// Number of a node, -1 if it is not in the set. Only after number_nodes; thread-safe.
  Index find(const LatticeNode& node) const;
  /// All nodes by number. Only after number_nodes.
  const std::vector<LatticeNode>& nodes() const { return nodes_; }

 private:
  struct Block {
    std::uint64_t key = 0;
    std::array<std::uint64_t, 2> bits{};
    Index first = 0;  // number of the block's first node
  };

  Index find_block(std::uint64_t key) const {
    return table_.find(key, [&](Index number) { return blocks_[static_cast<std::size_t>(number)].key == key; });
  }
  void list_block(std::size_t number);

  NumberTable table_;  // of blocks
  std::vector<Block> blocks_;
  std::vector<LatticeNode> nodes_;
};

/// Signed distance to a surface on a sparse set of lattice nodes: all nodes inside (negative) and all their neighbours.
/// Nodes that are not in the set are outside. Values matter only where a neighbour has another sign.
struct LatticeDistance {
  LatticeFrame frame;
  LatticeNodeSet nodes;        ///< numbered
  std::vector<double> values;  ///< per node, m
};

}  // namespace softreel
