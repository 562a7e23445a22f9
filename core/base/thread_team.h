/// Threads that wait awake for the next short loop.
///
/// A solver runs some hundred loops of a few microseconds a step (one per colour, sweep and level); waking a thread for
/// each would cost as much as the loop. Helpers that found nothing to do for a while sleep, so that a program at rest
/// costs nothing.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace softreel {

class ThreadTeam {
 public:
  /// helpers: threads beside the caller of `run`, at least 1; the first run starts them.
  explicit ThreadTeam(int helpers);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  /// Runs body(k) once for each k of [0, n), on the caller and on the helpers that come in time. False, with nothing
  /// run, if the team is at work already: for another thread, or for a loop around this one. body must not throw.
  bool run(std::int64_t n, const std::function<void(std::int64_t)>& body);

 private:
  void start_helpers();
  void help();
  void take_part();
  bool next_job(int& last) const;

  int size_of_team_;                ///< of the helpers; fewer than asked for where the system starts no more
  std::atomic<bool> taken_{false};  ///< by a caller of run
  // The job: written while no helper is in it, that is while it is closed and active_ is 0.
  const std::function<void(std::int64_t)>* body_ = nullptr;
  std::int64_t size_ = 0;
  std::atomic<std::int64_t> next_{0};
  std::atomic<bool> open_{false};
  std::atomic<int> active_{0};  ///< helpers that may be in the job
  std::atomic<int> jobs_{0};    ///< so far; wraps round
  std::atomic<bool> ending_{false};
  std::vector<std::thread> helpers_;
};

}  // namespace softreel
