/// The bars in motion, swept over all methods.
#pragma once

#include "tests/benchmark/precision/work_precision.h"

namespace softreel::bench {

ProblemResult measure_vibration(bool quick);
ProblemResult measure_drop(bool quick);
ProblemResult measure_settling(bool quick);

}  // namespace softreel::bench
