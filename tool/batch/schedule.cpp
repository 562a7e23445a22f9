#include "tool/batch/schedule.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace softreel {

Schedule::Schedule(const ScheduleLimits& limits, std::vector<double> expected_bytes)
    : limits_(limits), bytes_(std::move(expected_bytes)) {
  CHECK(limits.jobs >= 1);
  for (std::size_t job = 0; job < bytes_.size(); ++job) queue_.push_back({job, 0});
}

bool Schedule::fits(double bytes) const {
  if (running_ == 0) return true;
  return running_ < limits_.jobs && running_bytes_ + bytes <= limits_.bytes;
}

std::optional<std::size_t> Schedule::start_next() {
  for (auto candidate = queue_.begin(); candidate != queue_.end(); ++candidate) {
    if (fits(bytes_[candidate->job])) {
      const std::size_t job = candidate->job;
      for (auto before = queue_.begin(); before != candidate; ++before) before->passed_by += 1;
      queue_.erase(candidate);
      running_ += 1;
      running_bytes_ += bytes_[job];
      return job;
    }
    if (candidate->passed_by >= limits_.jobs) return std::nullopt;
  }
  return std::nullopt;
}

void Schedule::end(std::size_t job) {
  CHECK(running_ > 0);
  running_ -= 1;
  running_bytes_ = running_ == 0 ? 0 : running_bytes_ - bytes_[job];  // no round-off is carried on
}

void Schedule::wait_again(std::size_t job, double expected_bytes) {
  bytes_[job] = expected_bytes;
  queue_.push_front({job, 0});
}

std::vector<std::size_t> Schedule::give_up() {
  std::vector<std::size_t> left;
  for (const Waiting& waiting : queue_) left.push_back(waiting.job);
  queue_.clear();
  return left;
}

int default_jobs(int processors, double bytes, const std::vector<double>& expected_bytes) {
  constexpr int kThreadsOfAJob = 4;  // loading, filling and files take one thread, tracing takes any number
  const int by_processors = std::max(std::min(processors, 2), processors / kThreadsOfAJob);
  double greatest = 0;
  for (const double expected : expected_bytes)
    if (expected <= bytes) greatest = std::max(greatest, expected);
  const double by_memory = greatest > 0 ? std::floor(bytes / greatest) : by_processors;
  const auto by_number = static_cast<double>(std::max<std::size_t>(1, expected_bytes.size()));
  return static_cast<int>(std::min({static_cast<double>(by_processors), std::max(1.0, by_memory), by_number}));
}

int share_of_threads(int threads, int jobs_at_one_time, int running, std::size_t waiting) {
  const auto sharing =
      std::min(static_cast<std::size_t>(jobs_at_one_time), static_cast<std::size_t>(running) + 1 + waiting);
  return std::max(1, threads / static_cast<int>(sharing));
}

}  // namespace softreel
