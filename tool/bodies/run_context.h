/// What every stage is given: threads, messages, times, the cache, and whether to stop.
#pragma once

#include <atomic>

#include "core/base/error.h"
#include "core/base/log.h"
#include "core/base/parallel.h"
#include "core/base/timer.h"
#include "tool/cache/cache.h"

namespace softreel {

struct RunContext {
  const Threads& threads;  ///< their loops end with an Interrupt once `cancelled` is set
  const Log& log;
  StageTimes& times;
  const Cache& cache;
  const std::atomic<bool>& cancelled;  ///< set by Ctrl-C

  /// Throws an Error of kind Interrupt after Ctrl-C. Finished files stay.
  void stop_if_cancelled() const {
    if (cancelled) throw interrupted();
  }
};

}  // namespace softreel
