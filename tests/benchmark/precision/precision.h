/// Work-precision: error against processor time over mesh, time step, tolerance and scheme, beside rivals.
#pragma once

#include "tests/benchmark/bench.h"

namespace softreel::bench {

/// Beams, torsion and a creature in equilibrium; vibration, a dropped bar, a settling bar and a creature in motion.
void run_precision(const BenchOptions& options, Report& report);

}  // namespace softreel::bench
