/// Shading normals of a surface with hard edges: a vertex at which several smooth parts meet has one of each.
#pragma once

#include <vector>

#include "core/base/types.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Normals by number. The first ones are of the vertices in their order; those that hard edges add come after them.
struct CornerNormals {
  std::vector<Index> vertex_of;     ///< per normal the vertex that it is at
  std::vector<Vec3> normals;        ///< unit
  std::vector<Triangle> triangles;  ///< per triangle of the mesh the normals of its corners

  bool empty() const { return triangles.empty(); }
};

/// Normals at rest: as vertex_normals, but of each smooth part at a vertex by itself. Parts are what edges connect
/// whose triangles meet at no more than `crease` (radians between their normals); edges of more than two triangles
/// connect those of them that do. Empty if no vertex has more than one part: vertex_normals are those of the corners
/// then. Deterministic; time and memory about linear in the triangles.
CornerNormals corner_normals(const SurfaceMesh& mesh, double crease);

}  // namespace softreel
