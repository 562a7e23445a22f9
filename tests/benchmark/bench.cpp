#include "tests/benchmark/bench.h"

#include <ctime>

#include "tests/benchmark/dial/dial.h"
#include "tests/benchmark/limits/limits.h"
#include "tests/benchmark/precision/precision.h"
#include "tests/benchmark/scale/scale.h"
#include "tests/benchmark/stability/stability.h"

namespace softreel::bench {
namespace {

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

std::span<const Benchmark> benchmarks() {
  static const std::vector<Benchmark> all{
      {"precision", "Error against processor time, beside rivals and theory", run_precision},
      {"dial", "The error that solver.error believes in, beside the truth", run_dial},
      {"stability", "Bodies scrambled, stretched, twisted and abused, by every rotation method", run_stability},
      {"scale", "Time and memory from a thousand to ten million tetrahedra, on one thread and two", run_scale},
      {"limits", "What bounds the accuracy: locking of linear tetrahedra, and its remedies", run_limits},
  };
  return all;
}

double thread_seconds() {
  return seconds_of(CLOCK_THREAD_CPUTIME_ID);
}
double process_seconds() {
  return seconds_of(CLOCK_PROCESS_CPUTIME_ID);
}
double wall_seconds() {
  return seconds_of(CLOCK_MONOTONIC);
}

}  // namespace softreel::bench
