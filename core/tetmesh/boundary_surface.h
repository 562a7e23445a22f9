/// The boundary of given tetrahedra as a surface mesh, for bodies that come without a surface of their own.
#pragma once

#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Faces that belong to one element only, as triangles and polygons. Vertex v is node v of the mesh: nodes inside are
/// vertices that no triangle uses, so that an export in the order of the surface is one in the order of the nodes.
SurfaceMesh boundary_surface(const TetMesh& mesh);

}  // namespace softreel
