/// Where the boundary of stuffed tetrahedra and a surface are too far apart, wherever that is.
#pragma once

#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/boundary_fit.h"
#include "core/tetmesh/hole_caps.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {

/// Gaps of more than `limit` (m) in both directions, also inside triangles: of each triangle that has some, the
/// farthest among them. visible: what of the surface the boundary has to follow; tree: of all of it. What closes holes
/// is left out.
std::vector<BoundaryGap> find_all_gaps(const StuffedMesh& stuffed, const SurfaceMesh& visible, const TriangleTree& tree,
                                       const HoleCaps& caps, double limit, const Threads& threads);

}  // namespace softreel
