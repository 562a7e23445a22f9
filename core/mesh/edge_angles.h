/// Which way the triangles of a surface face, and at what angles they meet along its edges.
#pragma once

#include <vector>

#include "core/mesh/mesh_topology.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {

/// The triangles of a surface as they are connected, and their directions.
struct FacingTriangles {
  std::vector<Index> weld;           ///< per vertex the one that it counts as, as SurfaceMesh::joined
  std::vector<Triangle> triangles;   ///< of these
  std::vector<HalfEdge> half_edges;  ///< their sorted_half_edges
  /// Unit normal of each triangle. A needle, whose own is but rounding, has that of the triangle across its longest
  /// edge; zero where there is none, and of one that is a line or a point once welded.
  std::vector<Vec3> directions;
};
FacingTriangles facing_triangles(const SurfaceMesh& mesh);

/// Between two directions that are not zero, radians.
double angle_between(const Vec3& a, const Vec3& b);

/// Lengths of the edges that two triangles share.
struct EdgeLengths {
  double all = 0;
  double bent = 0;   ///< whose triangles meet at more than the first angle, up to the second
  double sharp = 0;  ///< at more than the second
};
/// bent, sharp: the angles, radians.
EdgeLengths measure_edges(const SurfaceMesh& mesh, double bent, double sharp);

}  // namespace softreel
