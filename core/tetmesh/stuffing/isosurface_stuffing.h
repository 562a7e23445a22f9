/// Tetrahedra whose boundary follows the zero surface of a signed distance: snap, cut and fill.
///
/// Labelle and Shewchuk, Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles, 2007. Dihedral angles
/// lie within 10.2 and 164.8 degrees for any values whatever.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/lattice/lattice_nodes.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// A node nearer to the surface than this fraction of an edge is warped onto it (Labelle and Shewchuk, table 1).
constexpr double kWarpLong = 0.24999, kWarpShort = 0.41189;

/// The angles that stuffing promises, degrees. The lower one is the worst of 9 million adversarial tetrahedra.
constexpr double kMinDihedral = 10.2, kMaxDihedral = 164.8;

/// Tetrahedra and what later stages want to know of their nodes.
struct StuffedMesh {
  TetMesh mesh;
  std::vector<Index> lattice_nodes;  ///< per mesh node: the lattice node it is, or the inside end of the edge it cuts
  std::vector<std::uint8_t> on_surface;  ///< per mesh node: may lie on the boundary
};

/// Fills the inside of `distance`. Nodes and elements come in the lattice's order, so that neighbours are near in
/// memory. The result may touch itself at edges and vertices; see boundary_mending.h.
StuffedMesh stuff_isosurface(const LatticeDistance& distance, const Threads& threads);

/// Samples a signed distance function (m, negative inside) on the lattice nodes of a box that holds the whole body.
/// Cost: every node of the box.
LatticeDistance sample_distance(const LatticeFrame& frame, const Bounds& box,
                                const std::function<double(const Vec3&)>& signed_distance);

}  // namespace softreel
