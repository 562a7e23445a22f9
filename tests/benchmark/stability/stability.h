/// Torture: scrambled, stretched, twisted and abused bodies, by every rotation method.
#pragma once

#include "tests/benchmark/bench.h"

namespace softreel::bench {

void run_stability(const BenchOptions& options, Report& report);

}  // namespace softreel::bench
