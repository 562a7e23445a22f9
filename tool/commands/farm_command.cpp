#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tool/commands/farm_submission.h"
#include "tool/commands/interruption.h"
#include "tool/farm/openjd.h"
#include "tool/farm/shell_text.h"
#include "tool/farm/slurm.h"
#include "tool/stages/shot_status.h"

namespace softreel {
namespace {

using Shots = std::vector<std::unique_ptr<FarmedShot>>;

constexpr std::chrono::seconds kPause(2);        ///< between looks at the cache
constexpr std::chrono::seconds kQueuePause(10);  ///< between questions to Slurm, which many others ask too
constexpr int kMostFailures = 30;                ///< of questions in a row: five minutes
constexpr std::chrono::seconds kPatience(15);    ///< until what a task wrote on another machine must be seen here

Shots read_shots(const FarmOptions& options) {
  Shots shots;
  std::map<std::string, std::string> places;
  for (const std::string& path : options.shots) {
    shots.push_back(std::make_unique<FarmedShot>(options, path));
    const FarmedShot& shot = *shots.back();
    const auto [place, is_new] = places.emplace(shot.site().records, path);
    if (!is_new)
      throw input_error(fmt::format(
          "{} and {}: both are called {} and write to {}.\n  Accepted: shots of different names or folders. Give them "
          "other names (shot.name), or submit them one by one with different --output.",
          place->second, path, shot.name(), shot.site().output));
  }
  return shots;
}

std::string engine_of(const FarmOptions& options, const FarmedShot& shot) {
  if (!options.engine.empty()) return options.engine;
  return options.retry && shot.record() ? shot.record()->engine : "slurm";
}

const FarmRecord& require_record(const FarmedShot& shot) {
  if (shot.record() && !shot.record()->tasks.empty()) return *shot.record();
  throw input_error(
      fmt::format("{}: nothing of this shot was submitted with the output folder {}.\n  Accepted with --status and "
                  "--retry: a shot that softreel farm submitted, with the same --output. {} submits it.",
                  shot.site().shot, shot.site().output, shell_command({"softreel", "farm", shot.site().shot})));
}

/// Slurm's queue if one of the shots was given to Slurm.
std::optional<Queue> ask_queue(const Shots& shots) {
  std::set<unsigned> users;
  for (const auto& shot : shots)
    if (shot->record() && shot->record()->engine == "slurm" && !shot->record()->tasks.empty())
      users.insert(shot->record()->user);
  if (users.empty()) return std::nullopt;
  return ask_slurm(users);
}

std::vector<TaskStatus> statuses_of(FarmedShot& shot, const std::optional<Queue>& queue) {
  const bool of_slurm = shot.record() && shot.record()->engine == "slurm";
  return shot.statuses(of_slurm ? queue : std::nullopt);
}

std::string jobs_text(const std::vector<SubmittedTask>& tasks) {
  std::string text;
  for (const SubmittedTask& task : tasks) text += (text.empty() ? "" : ", ") + task.job;
  return text;
}

std::string closing_line(const FarmedShot& shot, const FarmSummary& summary) {
  if (summary.all_done()) return "all done";
  if (summary.broken == 0)
    return fmt::format("{} of {} tasks to go", summary.running + summary.waiting,
                       summary.running + summary.waiting + summary.done);
  return fmt::format("{} of {} tasks failed, are stuck or lost; {} submits what is missing", summary.broken,
                     summary.running + summary.waiting + summary.done + summary.broken,
                     shell_command({"softreel", "farm", shot.site().shot, "--output", shot.site().output, "--retry"}));
}

/// Prints how all shots fare. Exit status 1 if a task of one is broken.
int print_statuses(const Shots& shots, const std::optional<Queue>& queue, const ShotOptions& options) {
  int broken = 0;
  std::string text, json;
  for (const auto& shot : shots) {
    if (!shot->record()) {  // all of it was there
      text += fmt::format("farm: {} in {}: nothing was to be done\n", shot->name(), shot->site().output);
      json += (json.empty() ? "" : ",\n") + status_json({{}, 0, shot->site(), {}, {}, {}}, {}, {});
      continue;
    }
    const std::vector<TaskStatus> statuses = statuses_of(*shot, queue);
    const auto told = [&](const SubmittedTask& task) { return shot->told(task); };
    const FarmSummary summary = summarize(statuses);
    broken += summary.broken;
    text += fmt::format("farm: {} in {}: {}\n{}", shot->name(), shot->site().output, closing_line(*shot, summary),
                        status_text(*shot->record(), statuses, told));
    json += (json.empty() ? "" : ",\n") + status_json(*shot->record(), statuses, told);
  }
  if (options.json)
    std::printf("{\"command\": \"farm\", \"shots\": [\n%s\n]}\n", json.c_str());
  else if (!options.quiet || broken > 0)
    std::printf("%s", text.c_str());
  return broken > 0 ? 1 : 0;
}

/// Throws unless nothing of the shot is in the queue: two submissions would do the same twice.
void require_idle(FarmedShot& shot, const std::vector<TaskStatus>& statuses) {
  const FarmSummary summary = summarize(statuses);
  if (summary.running + summary.waiting == 0) return;
  std::vector<SubmittedTask> tasks;
  for (const TaskStatus& status : statuses)
    if (status.state == TaskState::Running || status.state == TaskState::Waiting) tasks.push_back(status.task);
  throw input_error(
      fmt::format("{}: tasks of this shot are in Slurm's queue already: {}.\n  --status says how they fare; --retry "
                  "submits what they "
                  "do not make; scancel removes them.",
                  shot.site().shot, jobs_text(tasks)));
}

void warn_of_unknown_sizes(const FarmedShot& shot, Console& console) {
  const bool open =
      shot.session().shot().dial.is_on() && (shot.settings().memory.empty() || shot.settings().time.empty());
  if (open)
    console.warn(
        fmt::format("{}: solver.error chooses the meshes on the farm, so that memory and time of the tasks are guesses "
                    "from default "
                    "sizes. --memory and --time say better.",
                    shot.name()));
}

/// What is submitted, on a line for each job.
void say_submitted(const FarmedShot& shot, const FarmPlan& plan, const std::string& how, Console& console) {
  console.info(fmt::format("{}: {}", shot.name(), how));
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    const FarmJob& job = plan.jobs[i];
    std::vector<int> frames;
    for (const FrameChunk& task : job.tasks)
      for (int frame = task.first; frame <= task.last; ++frame) frames.push_back(frame);
    console.info(fmt::format("  {:9} frames {} in {} task{}, {} processors, {}, at most {} each", job_name(job),
                             frame_ranges(frames), job.tasks.size(), job.tasks.size() == 1 ? "" : "s",
                             plan.needs[i].cpus, format_bytes(plan.needs[i].bytes),
                             format_duration(plan.needs[i].seconds)));
  }
}

/// Which values of the submission hold beside new ones; paths in these start where those do.
void say_kept_sets(const FarmedShot& shot, const FarmOptions& options, Console& console) {
  if (options.shot.sets.empty() || shot.kept_sets().empty()) return;
  std::string kept;
  for (const std::string& set : shot.kept_sets()) kept += " --set " + shell_quoted(set);
  console.info(fmt::format("{}: besides what is given now, as it was submitted:{}; relative paths start in {}",
                           shot.name(), kept, shot.site().directory));
}

/// Submits what is missing of a shot, or shows it. False if nothing is.
bool submit(FarmedShot& shot, const FarmOptions& options, const std::optional<Queue>& queue, Console& console) {
  const std::string engine = engine_of(options, shot);
  const bool to_slurm = engine == "slurm";
  if (options.retry) {
    require_record(shot);
    say_kept_sets(shot, options, console);
  }
  std::vector<TaskStatus> statuses;
  if (queue && shot.record() && shot.record()->engine == "slurm") statuses = statuses_of(shot, queue);
  if (!options.retry && !options.shot.dry_run) require_idle(shot, statuses);
  const FarmPlan plan = plan_submission(shot, statuses, to_slurm ? kMostSlurmTasks : kMostOpenJdTasks);
  if (plan.jobs.empty()) {
    console.info(plan.kept.empty() ? fmt::format("{}: nothing to do: all that the shot asks for is in {}", shot.name(),
                                                 shot.site().output)
                                   : fmt::format("{}: nothing to submit: what is missing is in the queue: {}",
                                                 shot.name(), jobs_text(plan.kept)));
    return !plan.kept.empty();
  }
  warn_of_unknown_sizes(shot, console);
  const std::string path =
      options.template_path.empty() ? shot.site().output + "/" + shot.name() + ".openjd.json" : options.template_path;
  if (options.shot.dry_run) {
    say_submitted(shot, plan, "would submit (nothing is written)", console);
    std::printf("%s", to_slurm ? slurm_preview(shot, plan).c_str()
                               : openjd_template(shot.site(), plan.jobs, plan.needs).c_str());
    return true;
  }
  if (to_slurm) {
    submit_to_slurm(shot, plan);
    say_submitted(shot, plan, "submitted to Slurm; logs in " + log_folder(shot.site()), console);
  } else {
    say_submitted(shot, plan, "job template written to " + write_openjd(shot, plan, path), console);
  }
  return true;
}

/// Waits until all tasks are done or nothing goes on.
class Watch {
 public:
  Watch(const Shots& shots, Console& console) : shots_(shots), console_(console) {}

  void run() {
    int total = 0;
    for (const auto& shot : shots_) total += shot->frames().count();
    console_.begin("pictures", total);
    while (!is_over()) {
      console_.advance(total - missing_, fmt::format("{} tasks running, {} waiting", running_, waiting_));
      pause();
    }
    console_.end();
  }
  const std::optional<Queue>& queue() const { return queue_; }

 private:
  using Clock = std::chrono::steady_clock;

  bool is_over() {
    const auto now = Clock::now();
    if (!queue_ || now - asked_ >= kQueuePause) {
      ask();
      asked_ = now;
    }
    missing_ = running_ = waiting_ = 0;
    bool over = true, done = true;
    for (const auto& shot : shots_) {
      const FarmSummary summary = summarize(shot->statuses(queue_));
      missing_ += static_cast<int>(shot->progress(Thoroughness::Claims).no_picture.size());
      running_ += summary.running;
      waiting_ += summary.waiting;
      done = done && summary.all_done();
      over = over && (summary.all_done() || summary.has_stopped());
    }
    if (!over) quiet_since_ = now;
    // The last task may be gone from the queue before its files are seen here.
    return done || (over && now - quiet_since_ >= kPatience);
  }

  /// Slurm may be restarted meanwhile: what it said last holds for a while.
  void ask() {
    try {
      queue_ = ask_queue(shots_);
      failures_ = 0;
    } catch (const Error& error) {
      failures_ += 1;
      if (!queue_ || failures_ == kMostFailures) throw;
      console_.warn(fmt::format("Slurm does not answer; asked again in {} s: {}", kQueuePause.count(), error.what()));
    }
  }

  void pause() const {
    const auto end = Clock::now() + kPause;
    while (Clock::now() < end) {
      if (cancellation())
        throw Error(ErrorKind::Interrupt,
                    "Interrupted; the submitted tasks go on. softreel farm SHOT --status says how they fare.");
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  const Shots& shots_;
  Console& console_;
  std::optional<Queue> queue_;
  Clock::time_point asked_, quiet_since_ = Clock::now();
  int missing_ = 0, running_ = 0, waiting_ = 0, failures_ = 0;
};

int wait_for(const Shots& shots, const FarmOptions& options, Console& console) {
  for (const auto& shot : shots)
    if (shot->record() && shot->record()->engine != "slurm")
      throw input_error(
          fmt::format("{}: --wait: who runs the template that was written for this shot is not known here.\n  Accepted "
                      "for shots that "
                      "were submitted to Slurm. softreel farm SHOT --status says what is there.",
                      shot->site().shot));
  Watch watch(shots, console);
  watch.run();
  return print_statuses(shots, watch.queue(), options.shot);
}

void require_sense(const FarmOptions& options) {
  if (options.shot.dry_run && options.shot.json)
    throw input_error(
        "--json: says how submitted tasks fare, and a dry run submits none.\n"
        "  Accepted without --dry-run, which prints the commands and scripts.");
  if (options.wait && options.engine == "openjd")
    throw input_error(
        "--wait: whoever runs the template of --engine openjd is not known here.\n  Accepted with --engine slurm. "
        "softreel farm SHOT --status says what is there.");
}

/// After the shots were read: a retry's engine is that of its record.
void require_template_of_one_shot(const FarmOptions& options, const Shots& shots) {
  if (options.template_path.empty() || (shots.size() == 1 && engine_of(options, *shots.front()) == "openjd")) return;
  throw input_error(
      "--template: names the file of one shot's template.\n  Accepted with --engine openjd and one shot.");
}

}  // namespace

int run_farm(const FarmOptions& options) {
  require_sense(options);
  // Mistakes in any shot are said before anything is submitted.
  if (!options.settings.memory.empty()) parse_memory(options.settings.memory);
  if (!options.settings.time.empty()) parse_time(options.settings.time);
  const Shots shots = read_shots(options);
  require_template_of_one_shot(options, shots);
  Console console(options.shot.quiet ? Verbosity::Quiet : Verbosity::Normal, isatty(STDERR_FILENO) != 0);
  if (options.status) {
    for (const auto& shot : shots) require_record(*shot);
    return options.wait ? wait_for(shots, options, console) : print_statuses(shots, ask_queue(shots), options.shot);
  }
  const std::optional<Queue> queue = options.shot.dry_run ? std::nullopt : ask_queue(shots);
  bool any = false;
  for (const auto& shot : shots) any = submit(*shot, options, queue, console) || any;
  if (options.shot.dry_run) return 0;
  if (!any || !options.wait) {
    if (options.shot.json) print_statuses(shots, ask_queue(shots), options.shot);
    return 0;
  }
  return wait_for(shots, options, console);
}

}  // namespace softreel
