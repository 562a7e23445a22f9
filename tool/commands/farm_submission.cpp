#include "tool/commands/farm_submission.h"

#include <algorithm>
#include <exception>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/process.h"
#include "tool/farm/openjd.h"
#include "tool/farm/shell_text.h"
#include "tool/farm/slurm.h"

namespace softreel {
namespace {

bool covers(const std::vector<SubmittedTask>& tasks, FarmStep step, int frame) {
  return std::any_of(tasks.begin(), tasks.end(), [&](const SubmittedTask& task) {
    return task.step == step && task.frames.first <= frame && frame <= task.frames.last;
  });
}

/// Frames to simulate for the pictures of `frames`, which is not empty.
std::optional<FrameChunk> find_simulation(const Shot& shot, const ShotProgress& progress,
                                          const std::vector<int>& frames, const std::vector<SubmittedTask>& going_on) {
  if (shot.settings.mode == SimulationMode::Static && shot.settings.independent) {
    // Every frame stands for itself: only the tetrahedra are made before.
    if (progress.filled) return std::nullopt;
    return FrameChunk{frames.front(), frames.front()};
  }
  std::vector<int> missing;
  for (const int frame : progress.not_simulated)
    if (frame <= frames.back() + 1 && !covers(going_on, FarmStep::Simulate, frame)) missing.push_back(frame);
  if (missing.empty()) return std::nullopt;
  return FrameChunk{missing.front(), missing.back()};
}

/// What is left to do, given the tasks that go on.
FarmWork find_work(FarmedShot& shot, const std::vector<SubmittedTask>& going_on) {
  const ShotProgress progress = shot.progress(Thoroughness::Content);
  FarmWork work;
  for (const int frame : progress.no_picture)
    if (!covers(going_on, FarmStep::Frames, frame)) work.frames.push_back(frame);
  if (!work.frames.empty()) work.simulate = find_simulation(shot.session().shot(), progress, work.frames, going_on);
  if (progress.movie_missing || progress.sheet_missing) work.movie = shot.frames();
  return work;
}

bool is_in_queue(const TaskStatus& status) {
  return status.state == TaskState::Running || status.state == TaskState::Waiting || status.state == TaskState::Stuck;
}

/// The scheduler's names of what a job must wait for: the jobs of the plan, and tasks that go on.
std::vector<std::string> dependencies_of(const FarmPlan& plan, const FarmJob& job,
                                         const std::vector<std::string>& numbers) {
  std::vector<std::string> names;
  for (const std::size_t before : job.after) names.push_back(numbers[before]);
  for (const SubmittedTask& task : plan.kept)
    if (task.step < job.step) names.push_back(task.job);
  return names;
}

std::string script_path(const FarmedShot& shot, const FarmJob& job) {
  return shot.site().records + "/scripts/" + job_name(job) + ".sh";
}

std::vector<SubmittedTask> tasks_of(const FarmJob& job, const std::string& number) {
  std::vector<SubmittedTask> tasks;
  for (std::size_t i = 0; i < job.tasks.size(); ++i) {
    const std::string name = slurm_task(job, number, i);
    tasks.push_back({job.step, job.tasks[i], name, slurm_log(job, name)});
  }
  return tasks;
}

/// What the program printed. Throws work_error if it is not there or fails.
std::string run_slurm(const std::vector<std::string>& command) {
  std::string said;
  const int status = run_process(command, &said);
  if (const std::string why = why_not_started(status); !why.empty())
    throw work_error(fmt::format(
        "{}: the program {}; this machine has no Slurm that can be asked.\n"
        "  Run softreel farm where jobs are submitted from, or write a template for another farm with --engine openjd.",
        command.front(), why));
  if (status != 0)
    throw work_error(
        fmt::format("{} ended with status {}: {}", command.front(), status, said.empty() ? "nothing said" : said));
  return said;
}

void cancel(const std::vector<std::string>& jobs) {
  if (jobs.empty()) return;
  std::vector<std::string> command{"scancel"};
  command.insert(command.end(), jobs.begin(), jobs.end());
  run_slurm(command);
}

/// Those that have left the queue meanwhile need no cancelling, and make scancel fail.
void cancel_what_is_there(const std::vector<SubmittedTask>& tasks, unsigned user) {
  std::vector<std::string> jobs;
  for (const SubmittedTask& task : tasks) jobs.push_back(task.job);
  try {
    cancel(jobs);
  } catch (const Error&) {
    const Queue queue = ask_slurm({user});
    const auto is_there = [&](const std::string& job) {
      const auto entry = queue.find(job);
      return entry != queue.end() && is_live(entry->second);
    };
    if (std::any_of(jobs.begin(), jobs.end(), is_there)) throw;
  }
}

/// What is left of a submission when the next one was refused after it had cancelled some of its tasks.
FarmRecord without(FarmRecord record, const std::vector<SubmittedTask>& cancelled) {
  std::erase_if(record.tasks, [&](const SubmittedTask& task) {
    return std::any_of(cancelled.begin(), cancelled.end(),
                       [&](const SubmittedTask& one) { return one.job == task.job; });
  });
  return record;
}

/// Takes back what Slurm took of a submission that it refused; returns what to say if it does not let go.
std::string take_back(const std::vector<std::string>& numbers) {
  try {
    cancel(numbers);
    return {};
  } catch (const Error& error) {
    return fmt::format("\n  Still in the queue: {}. {}", fmt::join(numbers, ", "), error.what());
  }
}

FarmRecord new_record(const FarmedShot& shot, const FarmPlan& plan, const std::string& engine) {
  return {engine, ::getuid(), shot.site(), shot.frames(), shot.settings(), plan.kept};
}

std::vector<SubmittedTask> all_tasks(const FarmPlan& plan) {
  std::vector<SubmittedTask> tasks = plan.replaced;
  for (const FarmJob& job : plan.jobs)
    for (const FrameChunk& frames : job.tasks) tasks.push_back({job.step, frames, {}, {}});
  return tasks;
}

/// Tasks in the queue go on, unless they wait for one that failed, or for what does not come.
void keep_what_goes_on(const std::vector<TaskStatus>& statuses, FarmPlan& plan) {
  const bool broken = summarize(statuses).broken > 0;
  for (const TaskStatus& status : statuses) {
    const bool blocked = status.why == "Dependency" && broken && status.task.step != FarmStep::Simulate;
    const bool goes_on = status.state == TaskState::Running || (status.state == TaskState::Waiting && !blocked);
    if (is_in_queue(status)) (goes_on ? plan.kept : plan.replaced).push_back(status.task);
  }
}

/// A movie that waits in the queue is the one to make, unless there are frames that it does not wait for.
void settle_movie(FarmWork& work, FarmPlan& plan) {
  const auto waiting = std::find_if(plan.kept.begin(), plan.kept.end(),
                                    [](const SubmittedTask& task) { return task.step == FarmStep::Movie; });
  if (waiting == plan.kept.end()) return;
  if (work.frames.empty()) {
    work.movie.reset();
  } else {
    plan.replaced.push_back(*waiting);
    plan.kept.erase(waiting);
  }
}

}  // namespace

FarmPlan plan_submission(FarmedShot& shot, const std::vector<TaskStatus>& statuses, std::size_t most_tasks) {
  FarmPlan plan;
  keep_what_goes_on(statuses, plan);
  FarmWork work = find_work(shot, plan.kept);
  settle_movie(work, plan);
  const FarmEstimate estimate = shot.estimate(shot.settings().cpus > 0 ? shot.settings().cpus : kDefaultTaskCpus);
  const int chunk =
      shot.settings().chunk > 0 ? shot.settings().chunk : default_chunk(estimate, static_cast<int>(work.frames.size()));
  plan.jobs = plan_jobs(work, chunk, most_tasks);
  for (const FarmJob& job : plan.jobs) plan.needs.push_back(needs_of(job, estimate, shot.settings()));
  return plan;
}

void submit_to_slurm(FarmedShot& shot, const FarmPlan& plan) {
  shot.make_folders();
  std::vector<std::string> numbers;
  const std::optional<FarmRecord> before = shot.record();
  if (before) cancel_what_is_there(plan.replaced, before->user);
  const FarmedShot::TaskTexts forgotten = shot.forget(all_tasks(plan));
  FarmRecord record = new_record(shot, plan, "slurm");
  try {
    for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
      const FarmJob& job = plan.jobs[i];
      const std::string script = script_path(shot, job);
      write_file(script, slurm_script(shot.site(), job, plan.needs[i]));
      numbers.push_back(submitted_job(run_slurm(sbatch_command(shot.site(), job, plan.needs[i], shot.settings(),
                                                               dependencies_of(plan, job, numbers), script))));
      for (SubmittedTask& task : tasks_of(job, numbers.back())) record.tasks.push_back(std::move(task));
      shot.save(record);
    }
  } catch (const std::exception& refused) {
    std::string left = take_back(numbers);
    try {
      shot.save(before ? without(*before, plan.replaced) : new_record(shot, plan, "slurm"));
      shot.remember(forgotten);
    } catch (const std::exception& problem) {
      left += fmt::format("\n  {}", problem.what());
    }
    const auto* error = dynamic_cast<const Error*>(&refused);
    throw Error(error != nullptr ? error->kind() : ErrorKind::Work, refused.what() + left);
  }
}

std::string slurm_preview(const FarmedShot& shot, const FarmPlan& plan) {
  std::string text, scripts;
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    const FarmJob& job = plan.jobs[i];
    const std::string script = script_path(shot, job);
    text += shell_command(sbatch_command(shot.site(), job, plan.needs[i], shot.settings(),
                                         dependencies_of(plan, job, numbers), script)) +
            "\n";
    scripts += fmt::format("\n# ---- {}\n{}", job_name(job) + ".sh", slurm_script(shot.site(), job, plan.needs[i]));
    std::string number = "JOB_OF_" + job_name(job);
    std::replace(number.begin(), number.end(), '-', '_');
    numbers.push_back(number);
  }
  return text + scripts;
}

std::string write_openjd(FarmedShot& shot, const FarmPlan& plan, const std::string& path) {
  const std::string text = openjd_template(shot.site(), plan.jobs, plan.needs);
  shot.make_folders();
  shot.forget(all_tasks(plan));
  FarmRecord record = new_record(shot, plan, "openjd");
  for (const FarmJob& job : plan.jobs)
    for (const FrameChunk& frames : job.tasks)
      record.tasks.push_back({job.step, frames, {}, task_name(job.step, frames) + ".log"});
  write_file(path, text);
  shot.save(std::move(record));
  return path;
}

Queue ask_slurm(const std::set<unsigned>& users) {
  return parse_queue(run_slurm(squeue_command(users)));
}

}  // namespace softreel
