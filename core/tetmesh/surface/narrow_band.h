/// Unsigned distances from lattice nodes to a surface near them.
#pragma once

#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/tetmesh/lattice/bcc_lattice.h"

namespace softreel {

/// The band reaches as far as the longest lattice edge, in voxels of half the spacing: both ends of every edge that the
/// surface cuts are in it.
constexpr double kBandVoxels = 2.0;

/// A lattice node near the surface.
struct BandNode {
  LatticeNode node;
  double distance = 0;  ///< in units of half the lattice's spacing
  Index nearest = -1;   ///< the triangle nearest to it; of several the first
};

/// All nodes of the lattice at `frame` within kBandVoxels of the triangles, in an order that depends on the surface
/// only. Triangles with a corner that is not finite have no nodes. Cost: triangles and nodes of the band.
std::vector<BandNode> measure_narrow_band(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                                          const LatticeFrame& frame, const Threads& threads);

}  // namespace softreel
