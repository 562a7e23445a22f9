/// Draws the boundary of stuffed tetrahedra onto the surface, as far as the dihedral angles allow.
#pragma once

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/isosurface_stuffing.h"

namespace softreel {

/// What a fit may do to the angles, and how long it tries.
struct BoundaryFitParams {
  double min_dihedral = 15.0;   ///< degrees; stars of nodes that are worse already only improve
  double max_dihedral = 155.0;  ///< degrees; likewise
  int sweeps = 4;               ///< each moves every boundary node at most once
  double tolerance = 0.15;      ///< spacings: surface vertices that the boundary misses by less pull no node
};

/// Moves boundary nodes to the nearest point of the surface, or to a tip, ridge or groove of it that the boundary
/// misses, if that brings all faces round the node nearer to the surface. Elements, their order and who is neighbour of
/// whom stay; inner nodes do not move.
///
/// No element gets a dihedral angle beyond the two of `params` unless its neighbours had a worse one before. Cost: some
/// microseconds a boundary node and surface vertex. The bits do not depend on the number of threads.
void fit_boundary(StuffedMesh& stuffed, const SurfaceMesh& surface, const BoundaryFitParams& params,
                  const Threads& threads);

}  // namespace softreel
