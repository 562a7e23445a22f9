/// The error dial: the error that softreel believes its run to have beside the error that it has.
#pragma once

#include "tests/benchmark/bench.h"

namespace softreel::bench {

void run_dial(const BenchOptions& options, Report& report);

}  // namespace softreel::bench
