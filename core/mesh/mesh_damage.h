/// Where a surface is damaged: the edges and triangles that mesh_check counts.
#pragma once

#include <array>
#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Edges after vertices of exactly equal positions were welded; each once, from the vertex of the lower number.
struct MeshDamage {
  using Edge = std::array<Index, 2>;
  std::vector<Edge> boundary;      ///< of one triangle
  std::vector<Edge> non_manifold;  ///< of more than two triangles
  std::vector<Edge> flipped;       ///< of two triangles that run along it in the same direction
  /// Numbers of the triangles that face the other way than in the repaired mesh, ascending.
  std::vector<Index> turned;

  bool empty() const { return boundary.empty() && non_manifold.empty() && flipped.empty() && turned.empty(); }
};

/// repaired: `mesh` after repair_mesh. Cost: three sorts.
MeshDamage find_damage(const SurfaceMesh& mesh, const SurfaceMesh& repaired);

}  // namespace softreel
