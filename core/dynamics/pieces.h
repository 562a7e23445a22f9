/// Groups of nodes that elements connect: the pieces of a mesh, or the clusters of nodes that pins hold.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Numbered from 0 in the order of their first node.
struct Pieces {
  Index count = 0;
  std::vector<Index> of_node;  ///< per node; -1 for a node that belongs to none
};

/// Nodes are in one piece if a chain of elements connects them. members: per node, 0 leaves it out as if it were not
/// there; empty: all belong.
Pieces find_pieces(const std::vector<Tet>& tets, std::size_t nodes, std::span<const std::uint8_t> members = {});

}  // namespace softreel
