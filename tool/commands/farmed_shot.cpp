#include "tool/commands/farmed_shot.h"

#include <algorithm>
#include <filesystem>
#include <random>

#include <fmt/format.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tool/bodies/simulate_key.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/process.h"
#include "tool/commands/picture_wishes.h"
#include "tool/commands/plan_estimate.h"
#include "tool/report/version.h"
#include "tool/shot/plain_path.h"
#include "tool/shot/shot_layers.h"
#include "tool/shot/shot_load.h"
#include "tool/stages/scene_stage.h"

namespace softreel {
namespace fs = std::filesystem;
namespace {

std::string absolute(const std::string& path) {
  return plain_path(fs::absolute(path)).string();
}

std::string text_of(const std::string& path) {
  std::error_code none;
  if (!fs::is_regular_file(path, none)) return {};
  const auto bytes = read_file(path);
  return {bytes.begin(), bytes.end()};
}

std::string this_program() {
  return fs::read_symlink("/proc/self/exe").string();
}

std::string checksum_of_program() {
  std::string said;
  // Not /proc/self/exe: of the child that would be its own file.
  const int status = run_process({"sha256sum", fmt::format("/proc/{}/exe", ::getpid())}, &said);
  if (const std::string why = why_not_started(status); !why.empty())
    throw work_error(
        fmt::format("sha256sum: the program {}.\n  Install the package coreutils: nodes compare their softreel.", why));
  if (status != 0) throw work_error(fmt::format("sha256sum ended with status {}: {}", status, said));
  return said.substr(0, said.find(' '));
}

/// The output folder of a shot that need not be valid.
std::string output_of(const ShotOptions& options) {
  if (!options.output.empty()) return options.output;
  const TomlValue document = load_layers(options.shot, {});
  const TomlValue* output = document.find("output");
  const TomlValue* directory = output != nullptr ? output->find("directory") : nullptr;
  const std::string* said = directory != nullptr ? directory->text() : nullptr;
  return said != nullptr ? *said : OutputSettings().directory;
}

std::string new_token() {
  std::random_device random;
  return fmt::format("farm-{:08x}{:08x}", random(), random());
}

/// Those of before, but for fields that are given anew.
std::vector<std::string> sets_beside(const std::vector<std::string>& given, std::vector<std::string> before) {
  const auto path_of = [](const std::string& set) { return parse_override(set).path; };
  std::erase_if(before, [&](const std::string& old) {
    return std::any_of(given.begin(), given.end(),
                       [&](const std::string& set) { return path_of(set) == path_of(old); });
  });
  return before;
}

/// Another working directory while the object lives: paths in --set are relative to it.
class WorkingDirectory {
 public:
  explicit WorkingDirectory(const std::string& folder) : before_(fs::current_path()) {
    std::error_code failed;
    fs::current_path(folder, failed);
    if (failed)
      throw input_error(fmt::format(
          "{}: the shot was submitted from this folder, where relative paths in its --set start; it cannot be entered: "
          "{}.\n  Accepted: a folder that is there. Make it, or submit the shot anew, without --retry.",
          folder, failed.message()));
  }
  ~WorkingDirectory() {
    std::error_code none;
    fs::current_path(before_, none);
  }
  WorkingDirectory(const WorkingDirectory&) = delete;
  WorkingDirectory& operator=(const WorkingDirectory&) = delete;

 private:
  fs::path before_;
};

}  // namespace

FarmedShot::FarmedShot(const FarmOptions& options, const std::string& shot) : settings_(options.settings) {
  ShotOptions one = options.shot;
  one.quiet = true;
  one.shot = absolute(shot);
  if (!one.output.empty()) one.output = absolute(one.output);
  if (!one.cache.empty()) one.cache = absolute(one.cache);
  const bool continues = options.status || options.retry;
  try {
    open(one);
    find_site(one);
    load_record();
  } catch (const Error& problem) {
    if (problem.kind() != ErrorKind::Input || !continues || !take_only_record(one)) throw;
  }
  if (!record_ && continues) take_only_record(one);
  if (!options.status) site_.checksum = checksum_of_program();
  if (record_ && continues) continue_record(options, one);
}

/// The record of a shot that can be read, or is called as it was submitted, with the submission's --set only. False
/// unless the output folder has exactly one of this shot.
bool FarmedShot::take_only_record(const ShotOptions& one) {
  std::vector<FarmRecord> records;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(absolute(output_of(one)) + "/.farm", none)) {
    const std::string path = entry.path().string() + "/submission.json", text = text_of(path);
    if (text.empty()) continue;
    FarmRecord record = parse_farm_record(text, path);
    if (record.shot.shot == one.shot) records.push_back(std::move(record));
  }
  if (records.size() != 1) return false;
  site_ = records.front().shot;
  record_ = std::move(records.front());
  return true;
}

void FarmedShot::continue_record(const FarmOptions& options, ShotOptions one) {
  settings_ = merged(record_->settings, options.settings);
  one.output = site_.output;
  if (one.cache.empty()) one.cache = record_->shot.cache;
  if (one.frames.empty()) one.frames = fmt::format("{}-{}", record_->frames.first, record_->frames.last);
  if (one.cache_limit_gb < 0) one.cache_limit_gb = record_->shot.cache_limit_gb;
  const FarmShot before = site_;
  kept_sets_ = sets_beside(one.sets, record_->shot.sets);
  if (kept_sets_.empty() && one.sets.empty()) {
    open(one);
    find_site(one);
  } else {
    one.sets.insert(one.sets.begin(), kept_sets_.begin(), kept_sets_.end());
    const WorkingDirectory there(record_->shot.directory);
    open(one);
    find_site(one);
  }
  site_.token = before.token;
  site_.checksum = before.checksum;
}

void FarmedShot::open(const ShotOptions& options) {
  auto session = std::make_unique<Session>(options);
  require_any_picture(session->shot());  // here rather than in every task
  session_ = std::move(session);
}

void FarmedShot::find_site(const ShotOptions& options) {
  site_.name = settings_.name.empty() ? name() : settings_.name;
  site_.shot = options.shot;
  site_.output = absolute(session_->shot().output.directory);
  site_.cache = absolute(session_->context().cache.folder());
  site_.records = site_.output + "/.farm/" + name();
  site_.directory = fs::current_path().string();
  site_.sets = options.sets;
  site_.cache_limit_gb = session_->cache_limit() > 0 ? session_->cache_limit() / 1e9 : -1;
  site_.program = settings_.program.empty() ? this_program() : absolute(settings_.program);
  site_.version = short_version();
}

void FarmedShot::load_record() {
  const std::string path = site_.records + "/submission.json";
  const std::string text = text_of(path);
  if (!text.empty()) record_ = parse_farm_record(text, path);
  site_.token = record_ ? record_->shot.token : new_token();
}

ShotRun& FarmedShot::run() {
  const Shot& shot = session_->shot();
  bool turned = run_ != nullptr;
  for (std::size_t b = 0; turned && shot.dial.is_on() && b < run_->body_count(); ++b)
    turned = run_->dial(b).has_value();
  // The error dial is turned on the farm: keys of what hangs on it are known when its results are in the cache.
  if (!turned) run_ = std::make_unique<ShotRun>(shot, session_->context(), DialUse::LookUp);
  return *run_;
}

ShotProgress FarmedShot::progress(Thoroughness how) {
  const WorkingDirectory there(site_.directory);  // relative paths in --set start there
  Outputs outputs(session_->shot().output.directory, name(), session_->context().log);
  return find_progress(run(), outputs, frames().first, frames().last, how);
}

FarmEstimate FarmedShot::estimate(int cpus) {
  const WorkingDirectory there(site_.directory);
  Outputs outputs(session_->shot().output.directory, name(), session_->context().log);
  ShotRun& current = run();
  const SceneStage scenes(current);
  const PictureStage pictures(scenes, session_->shot(), outputs, session_->context());
  const PlanEstimate plan = estimate_plan(current, scenes, pictures, session_->frames(), cpus);
  return {plan.bytes, plan.fill_seconds, plan.simulate_seconds,
          plan.traced > 0 ? plan.render_seconds / plan.traced : 0.0};
}

std::vector<TaskStatus> FarmedShot::statuses(const std::optional<Queue>& queue) {
  if (!record_) return {};
  const ShotProgress there = progress(Thoroughness::Claims);
  const auto touches = [](const std::vector<int>& missing, const FrameChunk& range) {
    const auto first = std::lower_bound(missing.begin(), missing.end(), range.first);
    return first != missing.end() && *first <= range.last;
  };
  const IsThere is_there = [&](const SubmittedTask& task) {
    switch (task.step) {
      case FarmStep::Simulate:  // what it made may have gone again when all pictures were there
        return there.no_picture.empty() || (there.filled && !touches(there.not_simulated, task.frames));
      case FarmStep::Frames:
        return !touches(there.no_picture, task.frames);
      case FarmStep::Movie:
        return !there.movie_missing && !there.sheet_missing;
    }
    return false;
  };
  const SaidOf said_of = [&](const SubmittedTask& task) {
    return parse_task_record(text_of(record_path(site_, task_name(task.step, task.frames))));
  };
  return find_task_statuses(*record_, queue, is_there, said_of);
}

std::string FarmedShot::told(const SubmittedTask& task) const {
  if (task.log.empty()) return {};
  const std::string path = log_folder(site_) + "/" + task.log;
  std::error_code none;
  if (!fs::exists(path, none)) return "there is no log: the task did not start, or its node does not see the folder";
  return telling_line(text_of(path));
}

void FarmedShot::make_folders() const {
  for (const char* folder : {"tasks", "logs", "scripts"}) make_folder(site_.records + "/" + folder);
  require_writable(site_.cache);
  for (const std::string& token : {site_.records + "/" + site_.token, cache_token_path(site_)})
    write_file(token, std::string("softreel farm: nodes that see this file see the right folder\n"));
}

void FarmedShot::save(FarmRecord record) {
  write_file(site_.records + "/submission.json", to_json(record));
  record_ = std::move(record);
}

FarmedShot::TaskTexts FarmedShot::forget(const std::vector<SubmittedTask>& tasks) const {
  TaskTexts texts;
  for (const SubmittedTask& task : tasks) {
    const std::string path = record_path(site_, task_name(task.step, task.frames));
    std::error_code none;
    if (fs::exists(path, none)) texts[path] = text_of(path);
    fs::remove(path, none);
  }
  return texts;
}

void FarmedShot::remember(const TaskTexts& texts) const {
  for (const auto& [path, text] : texts) write_file(path, text);
}

}  // namespace softreel
