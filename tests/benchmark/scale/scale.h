/// Time and memory over the number of tetrahedra, on one thread and on two.
#pragma once

#include "tests/benchmark/bench.h"

namespace softreel::bench {

/// Benchmark::run of "scale". Each point is measured by scale_point in a process of its own.
void run_scale(const BenchOptions& options, Report& report);

/// Exponent p of the least-squares fit y = c x^p. Needs two points or more, all above 0.
double fit_exponent(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace softreel::bench
