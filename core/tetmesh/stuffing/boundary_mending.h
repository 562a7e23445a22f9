/// Makes the boundary of stuffed tetrahedra a manifold: no two parts touch at a lone vertex or edge.
#pragma once

#include "core/tetmesh/stuffing/isosurface_stuffing.h"

namespace softreel {

/// Faces that belong to one element only, nodes sorted: boundary_faces without the inside, as only faces of surface
/// nodes can be there.
std::vector<BoundaryFace> find_surface_faces(const StuffedMesh& stuffed);

/// What was done.
struct BoundaryMending {
  Index copied_nodes = 0;  ///< a node where parts touched became one node a part
  Index removed_tets = 0;  ///< elements taken away where a part touched itself and copying could not part it
};

/// Parts that touch at a vertex get a node each. Where a part touches itself at an edge, all but the largest fan of
/// elements round the edge go; where its outside meets itself at a vertex, the shortest row of elements between goes.
/// Parts that are joined through faces stay joined. Cost: linear in the elements, times the few rounds it takes.
BoundaryMending mend_boundary(StuffedMesh& stuffed);

}  // namespace softreel
