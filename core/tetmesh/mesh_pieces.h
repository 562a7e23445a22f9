/// Splits stuffed tetrahedra into pieces, drops crumbs, and notices parts of the surface that were lost.
#pragma once

#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/tetmesh/isosurface_stuffing.h"
#include "core/tetmesh/surface_parts.h"

namespace softreel {

/// Removes pieces smaller than a cell of the lattice that are not the largest piece of any part of the surface. Says in
/// `log` what was removed, and warns of a part that fell into several pieces. Expects a manifold boundary.
/// nearest_triangles, here and below: per lattice node a triangle near it, -1 if none is.
void drop_crumbs(StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles, const SurfaceParts& parts,
                 const std::string& name, const Log& log);

/// Throws input_error if a part with a volume has no tetrahedron: names it and the edge length that it needs. Warns of
/// parts without volume and of cavities that vanished.
void require_all_parts(const StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles,
                       const SurfaceParts& parts, const std::string& name, const Log& log);

/// Renumbers the nodes in the order of the lattice and drops those that no element uses.
void order_nodes(StuffedMesh& stuffed);

}  // namespace softreel
