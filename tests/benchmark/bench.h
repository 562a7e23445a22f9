/// softreel_bench: sub-benchmarks that measure, and the report that they write together.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tests/benchmark/report/report.h"

namespace softreel::bench {

/// How much is measured. Everything runs on one thread, in processor time, but for what a section says of itself.
struct BenchOptions {
  bool quick = false;  ///< smaller meshes, fewer seeds: all of them together within 3 minutes on 2 cores
};

/// A sub-benchmark: fills a section of the report. Throws std::exception if it could not measure.
struct Benchmark {
  const char* name;     ///< as on the command line
  const char* summary;  ///< one line of `softreel bench --list`
  void (*run)(const BenchOptions& options, Report& report);
};

/// All of them, in the order of the report. Each `run` stands in the folder of its name.
std::span<const Benchmark> benchmarks();

/// Processor time that this thread has used, s: what other jobs of a shared machine disturb least.
double thread_seconds();

/// Processor time of all threads of this process, s.
double process_seconds();

/// Time on the wall since some moment, s.
double wall_seconds();

}  // namespace softreel::bench
