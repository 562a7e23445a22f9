/// Embedded mode: whole tetrahedra of a BCC lattice that cover a solid, weighted by how much of each it fills.
///
/// Each lattice tetrahedron is there once for each connected part of the solid within it (cell_parts.h); copies of
/// neighbouring cells are joined at their common face where the surface or the inside of one part passes through it.
/// What is joined in the solid is joined in the tetrahedra, and two fingers in one cell move apart. After Teran et al.,
/// Creating and Simulating Skeletal Muscle from the Visible Human Data Set, 2005, and Nesme et al., Preserving Topology
/// and Elasticity for Embedded Deformable Models, 2009; parts are found from the surface itself instead of from finer
/// voxels, so that no part is too thin to be seen.
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/surface/surface_parts.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Smallest fill of an element: what is empty but for a sliver must still have a stiffness, for the solver.
constexpr double kLeastFill = 1e-6;

/// A point that the elements are to carry: a vertex of the surface, or of what the surface was made from.
struct CarriedPoint {
  Vec3 position;
  Index vertex = -1;  ///< of the covered surface; -1: found by place, in the part whose triangle is nearest
};

struct EmbeddedLattice {
  TetMesh mesh;         ///< with fill, and carriers per carried point: -1 for one outside all elements
  Index cut_cells = 0;  ///< lattice tetrahedra that the surface passes
  Index copies = 0;     ///< elements beyond the first of their lattice tetrahedron
  Index branches = 0;   ///< pairs, each copy with the next at a face of one lattice tetrahedron, where limbs side by
                        ///< side in it join: there alone the boundary is no manifold, for three elements meet at a face
};

/// Covers a surface at the lattice of `frame`. Every triangle lies in elements, and with its vertices in those of its
/// own part. Nodes and elements come in the lattice's order. Independent of the number of threads. Cost: linear in
/// cells and triangles.
EmbeddedLattice cover_with_lattice(const SurfaceMesh& surface, const SurfaceParts& parts, const LatticeFrame& frame,
                                   std::span<const CarriedPoint> points, const Threads& threads);

/// What a report says of such a mesh.
struct EmbeddedFacts {
  Index cut_cells = 0;     ///< elements that are not filled
  Index copies = 0;        ///< elements beyond the first in their place
  double cell_volume = 0;  ///< of all elements, filled or not, m^3
};
EmbeddedFacts describe_embedded(const TetMesh& mesh);

}  // namespace softreel
