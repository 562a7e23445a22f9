/// Runs the jobs of a batch, each a process of its own.
#pragma once

#include <atomic>
#include <string>

#include "tool/batch/batch_display.h"
#include "tool/batch/batch_result.h"

namespace softreel {

struct BatchLimits {
  int jobs = 0;      ///< at one time; 0: by processors and memory
  double bytes = 0;  ///< that all running jobs may be expected to need; 0: what the machine has left
  int threads = 0;   ///< of all running jobs together; 0: all processors
  int retries = 0;   ///< of a job that crashed
  bool fail_fast = false;
};

/// The jobs with what each would do: softreel is asked in a process of its own. A job whose shot or meshes cannot be
/// read has failed already.
BatchResult plan_batch(std::vector<BatchJob> jobs, const BatchLimits& limits, const std::atomic<bool>& cancelled);

/// Runs what is missing. A job that fails, crashes or runs out of memory touches no other; once `cancelled` is set, all
/// that run are asked to end, and ended two seconds later.
void run_batch_jobs(BatchResult& batch, const BatchLimits& limits, BatchDisplay& display,
                    const std::atomic<bool>& cancelled);

}  // namespace softreel
