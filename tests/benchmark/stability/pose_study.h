/// Tables, curves and pictures of stretched and twisted bars, by every rotation method.
#pragma once

#include "tests/benchmark/bench.h"

namespace softreel::bench {

/// Flutter at rest over stretch, with and without the cap on the dilatation stress.
void study_stretch(const BenchOptions& options, Report& report);

/// How far the default's one solve a step goes before a stretched bar or a compressed block flutters: by stiffness,
/// slenderness and step.
void study_one_solve(const BenchOptions& options, Report& report);

/// Turns that are held over turns commanded.
void study_twist(const BenchOptions& options, Report& report);

}  // namespace softreel::bench
