/// What bounds the accuracy: how much linear tetrahedra lock, and which remedy would move the curve most.
#pragma once

#include "tests/benchmark/bench.h"

namespace softreel::bench {

/// Sub-benchmark "limits": sag of a clamped bar over mesh size and Poisson's ratio, linear tetrahedra beside 10-node
/// ones and nodal averages, at equal cost. Small-strain statics: see strain_cells.h.
void run_limits(const BenchOptions& options, Report& report);

}  // namespace softreel::bench
