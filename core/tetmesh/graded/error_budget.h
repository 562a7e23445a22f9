/// Graded tetrahedra that keep to an error budget or to a count: fine where the surface asks for it, coarse elsewhere.
#pragma once

#include <optional>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/boundary/boundary_fit.h"
#include "core/tetmesh/stuffing/isosurface_stuffing.h"
#include "core/tetmesh/surface/signed_distance.h"

namespace softreel {

/// What graded filling may choose from. Exactly one of error, tets and base_edge is set by the caller.
struct ErrorBudgetParams {
  double error = 0;           ///< wanted two-way distance to the surface, m
  double tets = 0;            ///< wanted number of tetrahedra
  double base_edge = 0;       ///< long edges at the surface where nothing asks for less, m; 0: chosen
  int finer = 6;              ///< halvings of the base edge, at most
  int coarser = 2;            ///< doublings of the base edge in the inside, at most
  double loose_share = 0.02;  ///< pieces of at most this share of the elements are refined until they hang together
  std::vector<Index> triangle_solids = {};  ///< but for the main ones of these (find_main_pieces)
  double fit_tolerance = 0.7;  ///< boundary nodes are moved for what is further away, in units of the error
};

/// A graded mesh and what it was made from.
struct GradedFilling {
  StuffedMesh stuffed;                    ///< its lattice is that of the base edge
  std::vector<Index> nearest_triangles;   ///< per lattice node of `stuffed`: a triangle near it, -1: there is none
  double finest_edge = 0;                 ///< m
  bool is_kept = false;                   ///< the error: measured, not only hoped for
  std::optional<BoundaryGap> widest_gap;  ///< of an error that is not kept: where it is missed most
};

/// Fills, fits, measures, and refines where the boundary and the surface are further apart than `error`, until they are
/// nowhere, or the finest edge is reached there, or nothing helps any more. Caps of holes (hole_caps.h) do not count.
/// With `tets` the widest gaps are refined first until there are so many, within 5 %; the base edge is chosen, again
/// where one has too many by itself or leaves nothing to refine. With base_edge alone there is no refinement. The
/// boundary is a manifold. Equal bits at any number of threads. Cost: about five times that of the last mesh.
GradedFilling fill_graded(const SurfaceMesh& surface, const ErrorBudgetParams& params, const Threads& threads);

}  // namespace softreel
