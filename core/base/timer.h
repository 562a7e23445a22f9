/// Nested named stages and where their time went ("simulate/solve"); the names are those of the paper's Table 1.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace softreel {

/// Wall time since `start`, s.
inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Seconds and calls per stage name. Names are paths with '/', so that a report can show the tree. Thread-safe.
class StageTimes {
 public:
  struct Entry {
    double seconds = 0;
    std::int64_t calls = 0;
  };

  void add(const std::string& name, double seconds);
  /// A copy of all entries, sorted by name.
  std::map<std::string, Entry> entries() const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Entry> entries_;
};

/// Adds the wall time between construction and destruction to one stage.
class ScopedStage {
 public:
  ScopedStage(StageTimes& times, std::string name)
      : times_(times), name_(std::move(name)), start_(std::chrono::steady_clock::now()) {}
  ~ScopedStage() { times_.add(name_, seconds_since(start_)); }
  ScopedStage(const ScopedStage&) = delete;
  ScopedStage& operator=(const ScopedStage&) = delete;

 private:
  StageTimes& times_;
  std::string name_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace softreel
