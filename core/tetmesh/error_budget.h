/// Graded tetrahedra that keep to an error budget: fine where the surface asks for it, coarse elsewhere.
#pragma once

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/isosurface_stuffing.h"
#include "core/tetmesh/signed_distance.h"

namespace softreel {

/// What graded filling may choose from.
struct ErrorBudgetParams {
  double error = 0;            ///< wanted two-way distance to the surface, m
  double base_edge = 8;        ///< long edges at the surface where nothing asks for less, in units of `error`
  int finer = 4;               ///< halvings of the base edge, at most
  int coarser = 2;             ///< doublings of the base edge in the inside, at most
  double fit_tolerance = 0.5;  ///< boundary nodes are pulled by what the boundary misses by more, in units of `error`
};

/// A graded mesh and what it was made from.
struct GradedFilling {
  StuffedMesh stuffed;       ///< its lattice is that of the base edge
  SurfaceDistance distance;  ///< stuffed.lattice_nodes are its nodes
  double finest_edge = 0;    ///< m
};

/// Fills, measures, and refines where the boundary and the surface are further apart than the budget, until they are
/// nowhere or the finest edge is reached: at most `finer` + 3 times. The boundary is a manifold. Equal bits at any
/// number of threads. Cost: the last mesh, about twice.
GradedFilling fill_to_error(const SurfaceMesh& surface, const ErrorBudgetParams& params, const Threads& threads);

}  // namespace softreel
