/// Unsigned distances from lattice nodes to a surface near them: all that OpenVDB is asked for, and its entry as a
/// part.
#pragma once

#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/tetmesh/bcc_lattice.h"

namespace softreel {

/// The band reaches as far as the longest lattice edge, in voxels of half the spacing: both ends of every edge that the
/// surface cuts are in it.
constexpr double kBandVoxels = 2.0;

/// A lattice node near the surface.
struct BandNode {
  LatticeNode node;
  double distance = 0;  ///< in units of half the lattice's spacing
  Index nearest = -1;   ///< a triangle near it
};

/// Appends the nodes of the lattice at `frame` within kBandVoxels of the triangles, and some beyond, to `band`: in an
/// order of OpenVDB's that depends on the surface only. Its loops run on the arena of the caller.
extern "C" [[gnu::visibility("default")]] void softreel_measure_narrow_band(std::span<const Vec3> positions,
                                                                            std::span<const Triangle> triangles,
                                                                            const LatticeFrame& frame,
                                                                            std::vector<BandNode>& band);

}  // namespace softreel
