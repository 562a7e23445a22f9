#include "tool/batch/batch_run.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/timer.h"
#include "tool/batch/child_process.h"
#include "tool/batch/job_messages.h"
#include "tool/batch/machine.h"
#include "tool/batch/schedule.h"
#include "tool/cache/atomic_file.h"
#include "tool/report/log_file.h"

namespace softreel {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kBetweenLooks = 50;  ///< ms, at children that say nothing
constexpr std::chrono::milliseconds kChildPatience{2000};
constexpr double kUnknownBytes = 1e9;   ///< where no plan could be made
constexpr double kShareOfMemory = 0.9;  ///< of what is available; the rest is for the system
constexpr int kMostPlansAtOnce = 8;

std::vector<std::string> command_of(const BatchJob& job, const std::vector<std::string>& more) {
  std::vector<std::string> command{program_path()};
  command.insert(command.end(), job.arguments.begin(), job.arguments.end());
  command.insert(command.end(), more.begin(), more.end());
  // What is read of their messages must not hang on the environment's log level.
  command.insert(command.end(), {"--log-level", "info"});
  return command;
}

/// Asks children to end, and ends those that do not.
void stop(const std::vector<ChildProcess*>& children) {
  for (const ChildProcess* child : children) child->signal(SIGTERM);
  const auto start = Clock::now();
  const auto has_ended = [](ChildProcess* child) { return child->poll().has_value(); };
  while (!std::all_of(children.begin(), children.end(), has_ended) && Clock::now() - start < kChildPatience)
    ChildProcess::wait_for_any(children, kBetweenLooks);
  for (const ChildProcess* child : children) child->signal(SIGKILL);
}

bool ran_out_of_memory(const ProcessEnd& end, const std::string& said) {
  return end.signal == SIGKILL || (end.status == 1 && closing_message(said).starts_with("out of memory"));
}

std::string failure_message(const ProcessEnd& end, const std::string& said) {
  if (end.signal == 0) {
    const std::string message = closing_message(said);
    return message.empty() ? fmt::format("It ended with status {} and said nothing.", end.status) : message;
  }
  const std::string why =
      end.signal == SIGKILL ? "; the system does that when memory is short, and so does kill -9" : "";
  const std::string last = closing_message(said);
  return fmt::format("It was ended by {}{}. Frames that were finished are kept.{}", signal_text(end.signal), why,
                     last.empty() ? "" : "\n" + last);
}

/// Takes what a plan said, or why it could not be made.
void take_plan(JobResult& result, ChildProcess& child, const ProcessEnd& end) {
  if (end.signal != 0) return;  // the run itself will tell
  if (end.status == 0) {
    result.plan = plan_from_json(child.out());
    return;
  }
  result.state = JobState::Failed;
  result.status = end.status;
  result.message = failure_message(end, child.err());
  result.warnings = warnings_in(child.err());
}

void read_facts(const BatchJob& job, JobResult& result) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(job.report_path(), none)) return;
  const std::vector<std::uint8_t> bytes = read_file(job.report_path());
  result.facts = facts_from_json(std::string(bytes.begin(), bytes.end()));
}

void plan_all(BatchResult& batch, int at_one_time, const std::atomic<bool>& cancelled) {
  std::map<std::size_t, std::unique_ptr<ChildProcess>> running;
  std::size_t next = 0;
  while (next < batch.jobs.size() || !running.empty()) {
    std::vector<ChildProcess*> children;
    for (const auto& [job, child] : running) children.push_back(child.get());
    if (cancelled) {
      stop(children);
      throw interrupted();
    }
    for (; next < batch.jobs.size() && static_cast<int>(running.size()) < at_one_time; ++next) {
      if (batch.results[next].state != JobState::Waiting) continue;
      running[next] = std::make_unique<ChildProcess>(
          command_of(batch.jobs[next], {"--dry-run", "--json", "--threads", std::to_string(batch.threads)}));
      children.push_back(running[next].get());
    }
    ChildProcess::wait_for_any(children, kBetweenLooks);
    std::erase_if(running, [&](auto& entry) {
      const auto end = entry.second->poll();
      if (end) take_plan(batch.results[entry.first], *entry.second, *end);
      return end.has_value();
    });
  }
}

/// The jobs that run, and what is known of each of them.
class BatchRun {
 public:
  BatchRun(BatchResult& batch, const BatchLimits& limits, BatchDisplay& display)
      : batch_(batch), limits_(limits), display_(display), to_run_(jobs_to_run(batch)), schedule_(make_schedule()) {}

  void run(const std::atomic<bool>& cancelled) {
    double seconds = 0;
    for (const std::size_t job : to_run_) seconds += batch_.results[job].plan.seconds;
    display_.begin(to_run_.size(), seconds);
    while (schedule_.waiting() > 0 || !running_.empty()) {
      if (cancelled) return interrupt();
      while (const auto next = schedule_.start_next()) start(*next);
      display_.tick();
      ChildProcess::wait_for_any(children(), kBetweenLooks);
      look_at_children();
    }
  }

 private:
  struct Running {
    std::unique_ptr<ChildProcess> child;
    JobMessages messages;
    Clock::time_point start;
  };

  static std::vector<std::size_t> jobs_to_run(const BatchResult& batch) {
    std::vector<std::size_t> jobs;
    for (std::size_t job = 0; job < batch.jobs.size(); ++job)
      if (batch.results[job].state == JobState::Waiting) jobs.push_back(job);
    return jobs;
  }

  Schedule make_schedule() const {
    std::vector<double> bytes;
    for (const std::size_t job : to_run_) bytes.push_back(expected_bytes(batch_.results[job]));
    return {{batch_.jobs_at_one_time, batch_.bytes}, bytes};
  }

  static double expected_bytes(const JobResult& result) {
    return result.plan.known ? result.plan.bytes : kUnknownBytes;
  }

  std::vector<ChildProcess*> children() const {
    std::vector<ChildProcess*> all;
    for (const auto& [index, one] : running_) all.push_back(one.child.get());
    return all;
  }

  /// index: into to_run_, as the schedule counts.
  void start(std::size_t index) {
    const BatchJob& job = batch_.jobs[to_run_[index]];
    JobResult& result = batch_.results[to_run_[index]];
    result.alone = schedule_.needs_more_than_all(index);
    result.threads = result.alone ? batch_.threads
                                  : share_of_threads(batch_.threads, batch_.jobs_at_one_time, schedule_.running() - 1,
                                                     schedule_.waiting());
    result.attempts += 1;
    std::string how = fmt::format("{} thread{}, about {} expected", result.threads, result.threads == 1 ? "" : "s",
                                  format_bytes(schedule_.expected_bytes(index)));
    if (result.alone)
      display_.info(
          fmt::format("note: {} is expected to need {}, more than the {} for all jobs together: it runs alone.",
                      job.label(), format_bytes(schedule_.expected_bytes(index)), format_bytes(batch_.bytes)));
    display_.start(to_run_[index], job.label(), how, result.plan.seconds);
    Running& one = running_[index];
    one.start = Clock::now();
    std::vector<std::string> more{"--json", "--threads", std::to_string(result.threads)};
    if (!log_file().path().empty()) more.insert(more.end(), {"--log-file", log_file().path()});
    one.child = std::make_unique<ChildProcess>(command_of(job, more));
  }

  void look_at_children() {
    for (auto at = running_.begin(); at != running_.end();) {
      auto& [index, one] = *at;
      const auto end = one.child->poll();
      one.messages.read(one.child->err());
      display_.progress(to_run_[index], one.messages.done(), one.messages.total(), one.messages.note());
      if (end) take_end(index, one, *end);
      at = end ? running_.erase(at) : std::next(at);
    }
  }

  void take_end(std::size_t index, const Running& one, const ProcessEnd& end) {
    JobResult& result = batch_.results[to_run_[index]];
    const std::string& said = one.child->err();
    result.status = end.status;
    result.signal = end.signal;
    result.seconds += seconds_since(one.start);
    result.cpu_seconds += end.cpu_seconds;
    result.peak_bytes = std::max(result.peak_bytes, end.peak_bytes);
    result.warnings = warnings_in(said);
    schedule_.end(index);
    const bool is_done = end.signal == 0 && end.status == 0;
    const bool is_out_of_memory = !is_done && ran_out_of_memory(end, said);
    result.message = is_done ? "" : failure_message(end, said);
    const bool again = (end.signal != 0 || is_out_of_memory) && result.attempts <= limits_.retries;
    if (again) {
      const double expected = schedule_.expected_bytes(index);
      schedule_.wait_again(index, is_out_of_memory ? 2 * std::max(expected, end.peak_bytes) : expected);
    } else {
      result.state = is_done ? JobState::Done : JobState::Failed;
    }
    if (is_done) result.facts = facts_from_json(one.child->out());
    say_end(to_run_[index], again);
    if (result.state == JobState::Failed && limits_.fail_fast)
      for (const std::size_t left : schedule_.give_up()) batch_.results[to_run_[left]].state = JobState::NotStarted;
  }

  void say_end(std::size_t job, bool again) {
    const JobResult& result = batch_.results[job];
    const std::string label = batch_.jobs[job].label();
    if (result.state == JobState::Done)
      return display_.end(
          job, true, false,
          fmt::format("done    {} ({}, {})", label, format_duration(result.seconds), format_bytes(result.peak_bytes)));
    display_.end(job, !again, !again,
                 fmt::format("{}  {} ({}): {}", again ? "again " : "FAILED", label, format_duration(result.seconds),
                             result.message));
  }

  void interrupt() {
    stop(children());
    for (auto& [index, one] : running_) {
      JobResult& result = batch_.results[to_run_[index]];
      result.state = JobState::Interrupted;
      result.seconds += seconds_since(one.start);
    }
    running_.clear();
    for (const std::size_t left : schedule_.give_up()) batch_.results[to_run_[left]].state = JobState::NotStarted;
    batch_.interrupted = true;
  }

  BatchResult& batch_;
  const BatchLimits& limits_;
  BatchDisplay& display_;
  std::vector<std::size_t> to_run_;
  Schedule schedule_;
  std::map<std::size_t, Running> running_;
};

}  // namespace

BatchResult plan_batch(std::vector<BatchJob> jobs, const BatchLimits& limits, const std::atomic<bool>& cancelled) {
  BatchResult batch;
  batch.jobs = std::move(jobs);
  batch.results.resize(batch.jobs.size());
  batch.threads = limits.threads > 0 ? limits.threads : usable_processors();
  const double available = available_memory();
  batch.bytes =
      limits.bytes > 0 ? limits.bytes : std::min(kShareOfMemory * available, std::numeric_limits<double>::max());
  for (std::size_t job = 0; job < batch.jobs.size(); ++job) {
    if (batch.jobs[job].problem.empty()) continue;
    batch.results[job].state = JobState::Failed;
    batch.results[job].status = static_cast<int>(ErrorKind::Input);
    batch.results[job].message = batch.jobs[job].problem;
  }
  plan_all(batch, std::min(batch.threads, kMostPlansAtOnce), cancelled);
  std::vector<double> expected;
  for (std::size_t job = 0; job < batch.jobs.size(); ++job) {
    JobResult& result = batch.results[job];
    if (result.state != JobState::Waiting) continue;
    if (result.plan.complete) {
      result.state = JobState::UpToDate;
      read_facts(batch.jobs[job], result);
    } else if (result.plan.known) {
      expected.push_back(result.plan.bytes);
    }
  }
  batch.jobs_at_one_time = limits.jobs > 0 ? limits.jobs : default_jobs(batch.threads, batch.bytes, expected);
  return batch;
}

void run_batch_jobs(BatchResult& batch, const BatchLimits& limits, BatchDisplay& display,
                    const std::atomic<bool>& cancelled) {
  const auto start = Clock::now();
  BatchRun(batch, limits, display).run(cancelled);
  batch.seconds = seconds_since(start);
}

}  // namespace softreel
