/// Which jobs run at one time: within a number of jobs and an amount of memory, fair to large ones.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

namespace softreel {

struct ScheduleLimits {
  int jobs = 1;      ///< running at one time, at least 1
  double bytes = 0;  ///< that all running jobs together may be expected to need
};

/// Jobs 0, 1, 2, ... are started in their order, but for two rules.
///
/// - The expected bytes of all running jobs stay within the limit; a job that needs more than all of it runs alone.
/// - While a job waits for memory, later ones that fit may start first; each job lets at most `limits.jobs` of them
///   pass, and then all that wait behind it wait for it. So none waits for ever, however many small ones there are.
class Schedule {
 public:
  Schedule(const ScheduleLimits& limits, std::vector<double> expected_bytes);

  /// The job to start now, which counts as running from here on; nothing while none can.
  std::optional<std::size_t> start_next();
  /// A running job has ended.
  void end(std::size_t job);
  /// An ended job waits again, before all others, and is expected to need so much.
  void wait_again(std::size_t job, double expected_bytes);
  /// No waiting job is started any more; returns them.
  std::vector<std::size_t> give_up();

  bool needs_more_than_all(std::size_t job) const { return bytes_[job] > limits_.bytes; }
  double expected_bytes(std::size_t job) const { return bytes_[job]; }
  int running() const { return running_; }
  std::size_t waiting() const { return queue_.size(); }

 private:
  struct Waiting {
    std::size_t job;
    int passed_by;  ///< later jobs that started first
  };
  bool fits(double bytes) const;

  ScheduleLimits limits_;
  std::vector<double> bytes_;
  std::deque<Waiting> queue_;
  int running_ = 0;
  double running_bytes_ = 0;
};

/// How many jobs to run at one time where nobody said so: enough to keep `processors` busy through the parts of a job
/// that run on one, and no more than the greatest of them would find memory for.
int default_jobs(int processors, double bytes, const std::vector<double>& expected_bytes);

/// Threads of a job that starts while `running` others do and `waiting` more will follow: its share of `threads`, at
/// least 1.
int share_of_threads(int threads, int jobs_at_one_time, int running, std::size_t waiting);

}  // namespace softreel
