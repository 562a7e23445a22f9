/// Bars in equilibrium: small and large bending, torsion, and the bar of the performance targets under its weight.
#pragma once

#include "tests/benchmark/precision/work_precision.h"

namespace softreel::bench {

/// Tip of a cantilever 10 times as long as wide under a faint weight, against Timoshenko's beam and CalculiX.
ProblemResult measure_cantilever(bool quick);

/// Tip of a cantilever 50 times as long as wide under the dead loads P L^2 / (E I) = 1, 2, 5, 10, against the elastica.
ProblemResult measure_elastica(bool quick);

/// Torque over twist of a square bar, against Saint-Venant.
ProblemResult measure_torsion(bool quick);

/// Tip of the bar of the performance targets under its weight and under a tenth of it, against its own converged value
/// and against CalculiX.
ProblemResult measure_weighed_bar(bool quick);

}  // namespace softreel::bench
