/// Splits stuffed tetrahedra into pieces, drops crumbs, and notices parts of the surface that were lost.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/tetmesh/stuffing/isosurface_stuffing.h"
#include "core/tetmesh/surface/surface_parts.h"

namespace softreel {

/// What may be dropped as a crumb.
struct CrumbLimits {
  Index tets = std::numeric_limits<Index>::max();  ///< a crumb has fewer: what has many is cut off, not a crumb
  double share = 1;                                ///< all crumbs are at most this share of the volume, or all stay
};

/// Removes pieces smaller than a cell of the lattice that are not the largest piece of any part of the surface. Says in
/// `log` what was removed, and warns of much of it and of a part that fell into several pieces. Expects a manifold
/// boundary. nearest_triangles, here and below: per lattice node a triangle near it, -1 if none is. Returns the number
/// of pieces that are left.
Index drop_crumbs(StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles, const SurfaceParts& parts,
                  const CrumbLimits& limits, const std::string& name, const Log& log);

/// Per piece whether it is the largest one of a solid; a piece is of the solid that most of its nodes are near.
/// tet_pieces: numbers of the elements' pieces; triangle_solids: per triangle the solid that it bounds, -1 for none,
/// and empty if there is one alone.
std::vector<bool> find_main_pieces(const StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles,
                                   const std::vector<Index>& tet_pieces, const std::vector<Index>& triangle_solids);

/// Throws input_error if a part with a volume has no tetrahedron: names it and the edge length that it needs. Warns of
/// parts without volume and of cavities that vanished.
void require_all_parts(const StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles,
                       const SurfaceParts& parts, const std::string& name, const Log& log);

/// Renumbers the nodes in the order of the lattice and drops those that no element uses.
void order_nodes(StuffedMesh& stuffed);

}  // namespace softreel
