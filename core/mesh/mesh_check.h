/// What can be said of a surface before it is filled: holes, flips, duplicates, pieces, volume.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Facts of the triangles after vertices of exactly equal positions were welded. Collapsed triangles count as such and
/// nowhere else.
struct MeshFacts {
  std::int64_t vertices = 0;           ///< of the file
  std::int64_t used_vertices = 0;      ///< of the file, used by a triangle
  std::int64_t distinct_vertices = 0;  ///< used vertices after welding
  std::int64_t triangles = 0;
  std::int64_t edges = 0;
  std::int64_t boundary_edges = 0;       ///< of one triangle
  std::int64_t holes = 0;                ///< closed chains of boundary edges (an open sheet has one, too: its rim)
  std::int64_t non_manifold_edges = 0;   ///< of more than two triangles
  std::int64_t flipped_neighbours = 0;   ///< edges of two triangles that run along it in the same direction
  std::int64_t duplicate_triangles = 0;  ///< same corners as an earlier triangle, in any order
  std::int64_t collapsed_triangles = 0;  ///< two corners in one place
  std::int64_t flat_triangles = 0;       ///< three corners on a line: no area, but they close the surface
  std::int64_t pieces = 0;               ///< connected through shared vertices
  std::int64_t not_finite = 0;           ///< vertices with a coordinate that is NaN or infinite
  double signed_volume = 0;              ///< positive: faces point outward; of open surfaces: seen from the box centre
  Bounds bounds;                         ///< of the used vertices

  bool closed() const { return boundary_edges == 0 && non_manifold_edges == 0 && triangles > collapsed_triangles; }
};

/// Cost: two sorts (vertices and edges).
MeshFacts check_mesh(const SurfaceMesh& mesh);

/// One line of counts, then a line for each thing that deserves attention. A clean closed surface has one line.
std::vector<std::string> describe(const MeshFacts& facts);

}  // namespace softreel
