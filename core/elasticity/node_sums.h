/// Sums over the elements of what each does to its nodes, without an array that holds all of it.
///
/// Elements are cut into slabs of a fixed size. A slab adds up its own elements' vectors on its own nodes, which stay
/// in the first cache; each node then adds the few sums of its slabs. Both orders are those of the elements, so the
/// bits depend on nothing else.
///
/// Bound: 8 bytes of places an element, and 36 bytes for each sum of a slab: about 1.6 a node where neighbours in space
/// are neighbours in order. The array of all vectors would be 96 bytes an element, written and read again.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned.h"
#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/elasticity/element_lanes.h"

namespace softreel {

/// Batches of one slab.
inline constexpr std::size_t kSlabBatches = 256;

/// Which sums there are; made once for a body.
struct NodeSlabs {
  /// Of each batch, by node and lane: the place of the lane's node among its slab's sums.
  std::vector<std::uint16_t> places;
  /// Sums of slab s: [slab_offsets[s], slab_offsets[s + 1]), and the node of each.
  std::vector<std::uint32_t> slab_offsets;
  std::vector<Index> nodes;
  /// Sums of node i, by slabs: node_sums[node_offsets[i]] to node_sums[node_offsets[i + 1]].
  std::vector<std::uint32_t> node_offsets, node_sums;

  std::size_t sums() const { return slab_offsets.empty() ? 0 : slab_offsets.back(); }
  const std::uint16_t* places_of(std::size_t batch) const { return places.data() + 4 * kElementLanes * batch; }
};

/// 1 per node of a slab that has 1.
std::vector<std::uint8_t> nodes_of_slabs(const NodeSlabs& slabs, std::span<const std::uint8_t> chosen);

/// Sets 1 for every slab that has the node.
void choose_slabs_of(const NodeSlabs& slabs, Index node, std::span<std::uint8_t> chosen);

NodeSlabs make_node_slabs(const std::vector<Tet>& tets, std::size_t nodes);

/// vectors[i] = all sums of node i. sums: slabs.sums() x 4, the fourth scalar of each unused.
void add_slabs(const NodeSlabs& slabs, const AlignedVector<double>& sums, std::span<Vec3> vectors,
               const Threads& threads);

}  // namespace softreel
