/// Isosurface stuffing of tetrahedra of different sizes: snap, cut and fill between the leaves of an octree.
///
/// Labelle and Shewchuk, Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles, 2007, section 3.3.
#pragma once

#include "core/base/parallel.h"
#include "core/tetmesh/graded/graded_octree.h"
#include "core/tetmesh/stuffing/isosurface_stuffing.h"

namespace softreel {

/// The angles that graded meshes promise, degrees: those that the paper states. Ours choose their cuts otherwise and
/// stayed within 2.66 and 172.1 in adversarial trials.
constexpr double kMinGradedDihedral = 1.66, kMaxGradedDihedral = 174.72;

/// Fills the inside of values given per node of `nodes`, which are those of the octree: m, negative inside, right in
/// their signs and near the surface. lattice_nodes of the result: numbers in `nodes`. Serial, but linear.
StuffedMesh stuff_octree(const GradedOctree& octree, const LatticeNodeSet& nodes, const std::vector<double>& values);

}  // namespace softreel
