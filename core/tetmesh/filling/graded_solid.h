/// One solid filled with tetrahedra of graded sizes, in one piece.
#pragma once

#include <string>

#include "core/base/log.h"
#include "core/base/parallel.h"
#include "core/base/timer.h"
#include "core/tetmesh/filling/solids.h"
#include "core/tetmesh/graded/error_budget.h"
#include "core/tetmesh/stuffing/isosurface_stuffing.h"

namespace softreel {

struct GradedSolid {
  StuffedMesh stuffed;  ///< of no lattice
  double finest_edge;   ///< m
};

/// Fills, drops crumbs, and fills again with finer edges where pieces end that should hang together; they may still not
/// (require_whole). Says in `log` where an error budget could not be kept. name: the body's. Throws input_error if a
/// part has no tetrahedron.
GradedSolid grade_solid(const Solid& solid, const ErrorBudgetParams& params, const std::string& name,
                        const Threads& threads, const Log& log, StageTimes& times);

}  // namespace softreel
