#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <set>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/batch/batch_page.h"
#include "tool/batch/batch_run.h"
#include "tool/batch/junit.h"
#include "tool/cache/atomic_file.h"
#include "tool/commands/commands.h"
#include "tool/farm/shell_text.h"

namespace softreel {
namespace {

namespace fs = std::filesystem;

/// Making of pictures for the page of a batch that was interrupted; the page of such a batch may lack some.
constexpr std::chrono::milliseconds kPicturesWhenInterrupted(500);

/// The words that this program was started with.
std::string own_command_line() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, '\0');) words.push_back(word);
  if (!words.empty()) words.front() = "softreel";
  return shell_command(words);
}

/// Where the reports go if nobody said: where all the jobs' files or variants lie, or "out".
std::string report_folder(const BatchOptions& options, const std::vector<BatchJob>& jobs) {
  if (!options.report.empty()) return options.report;
  if (!options.shot.output.empty()) return options.shot.output;
  std::set<std::string> folders;
  for (const BatchJob& job : jobs)
    if (job.problem.empty())
      folders.insert(job.variant.empty() ? job.folder : fs::path(job.folder).parent_path().string());
  return folders.size() == 1 ? *folders.begin() : "out";
}

std::string to_do_text(const JobResult& result) {
  const JobPlan& plan = result.plan;
  if (result.state == JobState::Failed) return "cannot be run: " + result.message;
  if (!plan.known) return "unknown: softreel crashed when it looked at the shot";
  if (plan.complete) return "up to date";
  if (plan.trace_missing == 0) return fmt::format("finish: no frame of {} is missing", plan.trace_of);
  return fmt::format("simulate {} of {}, trace {} of {}", plan.simulate_missing, plan.simulate_of, plan.trace_missing,
                     plan.trace_of);
}

/// The list of a dry run.
void print_plan(const BatchResult& batch) {
  double seconds = 0;
  std::size_t width = 0;
  for (const BatchJob& job : batch.jobs) width = std::max(width, job.label().size());
  std::printf(
      "batch: would run (nothing is written), at most %d at one time, %d threads in all, within %s of memory:\n",
      batch.jobs_at_one_time, batch.threads, format_bytes(batch.bytes).c_str());
  for (std::size_t i = 0; i < batch.jobs.size(); ++i) {
    const JobResult& result = batch.results[i];
    const bool runs = result.state == JobState::Waiting;
    if (runs) seconds += result.plan.seconds;
    const std::string cost =
        !runs || !result.plan.known
            ? ""
            : fmt::format("; memory {}{}, time {}", format_bytes(result.plan.bytes),
                          result.plan.bytes > batch.bytes ? " (alone)" : "", format_duration(result.plan.seconds));
    std::printf("  %-*s  %s%s\n", static_cast<int>(width), batch.jobs[i].label().c_str(), to_do_text(result).c_str(),
                cost.c_str());
  }
  std::printf("  expected in all, within a factor of two: %s\n", format_duration(seconds).c_str());
}

struct ReportPaths {
  std::string json, junit, page;
};

ReportPaths write_reports(const BatchResult& batch, const std::string& folder, std::time_t start) {
  const fs::path place(folder);
  const ReportPaths paths{(place / "batch.json").string(), (place / "batch.junit.xml").string(),
                          (place / "batch.html").string()};
  const std::tm utc = fmt::gmtime(start);
  write_file(paths.json, to_json(batch) + "\n");
  write_file(paths.junit, to_junit(batch, fmt::format("{:%Y-%m-%dT%H:%M:%S}", utc), host_name()));
  // After an interruption there is a second or two for all of this, and pictures take the longest by far.
  const auto enough = std::chrono::steady_clock::now() + kPicturesWhenInterrupted;
  std::vector<JobPictures> pictures;
  for (std::size_t i = 0; i < batch.jobs.size(); ++i) {
    const JobResult& result = batch.results[i];
    const bool has_run = result.attempts > 0 || result.state == JobState::UpToDate;
    const bool has_time = !batch.interrupted || std::chrono::steady_clock::now() < enough;
    pictures.push_back(has_run && has_time && result.status != static_cast<int>(ErrorKind::Input)
                           ? make_job_pictures(batch.jobs[i], result.plan)
                           : JobPictures());
  }
  write_file(paths.page, batch_page(batch, pictures, fmt::format("{:%Y-%m-%d %H:%M} UTC", utc), host_name()));
  return paths;
}

void print_summary(const BatchResult& batch, const ReportPaths& paths) {
  std::printf("batch: %s, in %s\n", counts_text(batch).c_str(), format_duration(batch.seconds).c_str());
  for (std::size_t i = 0; i < batch.jobs.size(); ++i) {
    const JobResult& result = batch.results[i];
    std::string what = word_of(result.state);
    if (result.state == JobState::Done)
      what += fmt::format(" ({} frames traced, {}, {})", result.facts.traced, format_duration(result.seconds),
                          format_bytes(result.peak_bytes));
    std::printf("  %s: %s\n", batch.jobs[i].label().c_str(), what.c_str());
  }
  std::printf("  made: %s\n  made: %s\n  made: %s\n", paths.page.c_str(), paths.junit.c_str(), paths.json.c_str());
}

int run_dry(const BatchResult& batch, bool json) {
  if (json)
    std::printf("%s\n", to_json(batch).c_str());
  else
    print_plan(batch);
  return batch.count(JobState::Failed) > 0 ? 1 : 0;
}

}  // namespace

int run_batch(const BatchOptions& options) {
  const ShotOptions& shot = options.shot;
  const std::time_t start = std::time(nullptr);
  BatchDisplay display(shot.quiet ? Verbosity::Quiet : Verbosity::Normal, terminal_size());
  const BatchLimits limits{options.jobs, options.memory_gb * 1e9, shot.threads, options.retries, options.fail_fast};
  std::vector<BatchJob> jobs =
      make_jobs({options.shots, shot.sets, options.sweeps, shot.frames, shot.output, shot.cache, shot.cache_limit_gb});
  const std::string folder = report_folder(options, jobs);
  if (!shot.dry_run) require_writable(folder);
  wait_for_children_when_interrupted();
  display.info(fmt::format("batch: {} jobs; looking for what is there already", jobs.size()));
  BatchResult batch = plan_batch(std::move(jobs), limits, cancellation());
  batch.command = own_command_line();
  if (shot.dry_run) return run_dry(batch, shot.json);
  for (std::size_t i = 0; i < batch.jobs.size(); ++i)
    if (batch.results[i].state == JobState::Failed)
      display.warn(fmt::format("FAILED  {}: {}", batch.jobs[i].label(), batch.results[i].message));
  if (const int there = batch.count(JobState::UpToDate); there > 0)
    display.info(fmt::format("{} of {} jobs are up to date: nothing is run for them", there, batch.jobs.size()));
  run_batch_jobs(batch, limits, display, cancellation());
  display.finish();
  const ReportPaths paths = write_reports(batch, folder, start);
  if (shot.json)
    std::printf("%s\n", to_json(batch).c_str());
  else if (!shot.quiet)
    print_summary(batch, paths);
  if (batch.interrupted) throw interrupted();
  if (const int failed = batch.count(JobState::Failed); failed > 0)
    throw work_error(fmt::format(
        "{} of {} jobs failed; {}. See {}.", failed, batch.jobs.size(),
        batch.count(JobState::NotStarted) > 0 ? "the rest was not started (--fail-fast)" : "the others are done",
        paths.page));
  return 0;
}

}  // namespace softreel
