/// Which tetrahedron carries each point of a surface, and with which weights.
#pragma once

#include <array>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Tetrahedron and barycentric weights per surface point. Weights sum to 1; outside the mesh they are slightly
/// negative, and bounded: |w| <= 2, by going to the nearest point of the boundary otherwise.
struct Embedding {
  std::vector<Index> elements;                 ///< per point
  std::vector<std::array<double, 4>> weights;  ///< per point, in the order of the element's nodes
};

/// Embeds surface vertices. A point outside all tetrahedra goes to the nearest element, found along the part it
/// belongs to, never across a gap: candidates are the elements at the boundary whose outward side faces the point
/// along `normals` (unit, per point, pointing out of the surface). Deterministic; ties go to the lowest element.
/// A point that is no number, as files have them beside their faces, goes with the first node of the first element.
/// If the mesh knows its carriers, the points are the vertices of the surface it was made from, and go to those.
Embedding embed_points(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const TetMesh& mesh,
                       const Threads& threads);

}  // namespace softreel
