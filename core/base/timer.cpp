#include "core/base/timer.h"

namespace softreel {

void StageTimes::add(const std::string& name, double seconds) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[name];
  entry.seconds += seconds;
  entry.calls += 1;
}

std::map<std::string, StageTimes::Entry> StageTimes::entries() const {
  const std::lock_guard lock(mutex_);
  return entries_;
}

}  // namespace softreel
