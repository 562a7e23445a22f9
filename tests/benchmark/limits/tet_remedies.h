/// Tetrahedra with and without remedies against locking, as strain cells.
#pragma once

#include "core/tetmesh/tet_mesh.h"
#include "tests/benchmark/limits/strain_cells.h"

namespace softreel::bench {

enum class TetRemedy {
  None,           ///< linear tetrahedra: softreel's
  Quadratic,      ///< 10 nodes with straight edges, four points of quadrature
  NodalPressure,  ///< linear; the dilatation is averaged over the elements of each node
  NodalStrain     ///< linear; all of the strain is, with a share left to the elements against spurious modes
};

const char* name_of(TetRemedy remedy);

/// Quadratic: nodes at the middles of edges come after the mesh's own.
///
/// NodalPressure: J. Bonet, A. J. Burton, "A simple average nodal pressure tetrahedral element for incompressible and
/// nearly incompressible dynamic explicit applications", 1998, its energy at small strain: elements keep their
/// deviatoric part, node a has bulk / 2 times V_a times the square of the mean dilatation of its elements (by volume).
/// NodalStrain: C. R. Dohrmann et al., "Node-based uniform strain elements for three-node triangular and four-node
/// tetrahedral meshes", 2000, stabilised as M. A. Puso, J. Solberg, "A stabilized nodally integrated tetrahedral",
/// 2006: a share of 0.05 of the material, its lambda at most 25 mu, stays with the elements.
Discretization discretize(const TetMesh& mesh, TetRemedy remedy, const Lame& material);

}  // namespace softreel::bench
