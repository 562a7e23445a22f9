/// Where a closed surface overlaps itself.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Triangles near a place that the surface goes round more than once, as far as a row of the lattice at `frame` meets
/// it: 1, the others 0; empty if there is no such place. A triangle with the solid on both sides is near one. Near is
/// some spacings, or the same cell of some spacings. Cost: linear in triangles and crossings.
std::vector<std::uint8_t> find_near_overlaps(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                                             const LatticeFrame& frame);

}  // namespace softreel
