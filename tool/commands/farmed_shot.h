/// One shot of the command farm: the shot as its nodes see it, what of it is there, and what was submitted of it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tool/commands/farm_options.h"
#include "tool/farm/farm_record.h"
#include "tool/farm/farm_status.h"
#include "tool/stages/shot_progress.h"

namespace softreel {

class FarmedShot {
 public:
  /// Reads the shot, and the record of its last submission if there is one. To ask how that fares, or to retry, the
  /// shot is taken with the submission's --frames and --cache unless others are given, and with its --set beside those
  /// given; relative paths in any of them start where the shot was submitted.
  FarmedShot(const FarmOptions& options, const std::string& shot);

  const Session& session() const { return *session_; }
  const std::string& name() const { return session_->shot().settings.name; }
  /// All paths are absolute. The token is that of the record, or a new one.
  const FarmShot& site() const { return site_; }
  FrameChunk frames() const { return {session_->frames().first, session_->frames().last}; }
  /// What was given now, over what the record has if this is a retry.
  const FarmSettings& settings() const { return settings_; }
  const std::optional<FarmRecord>& record() const { return record_; }
  /// Values of the submission that hold beside those given now.
  const std::vector<std::string>& kept_sets() const { return kept_sets_; }

  ShotProgress progress(Thoroughness how);
  FarmEstimate estimate(int cpus);
  /// Of the record's tasks; queue: see find_task_statuses.
  std::vector<TaskStatus> statuses(const std::optional<Queue>& queue);
  /// What the log of a task says best about how it failed.
  std::string told(const SubmittedTask& task) const;

  /// Makes the folders, and in output and cache the file by which nodes know them.
  void make_folders() const;
  /// Writes the record, which becomes that of the last submission.
  void save(FarmRecord record);
  /// What tasks said of themselves, by the path of it.
  using TaskTexts = std::map<std::string, std::string>;
  /// That is forgotten, and returned.
  TaskTexts forget(const std::vector<SubmittedTask>& tasks) const;
  /// After all.
  void remember(const TaskTexts& texts) const;

 private:
  /// one: what was given of the shot, with absolute paths.
  void continue_record(const FarmOptions& options, ShotOptions one);
  void open(const ShotOptions& options);
  void load_record();
  bool take_only_record(const ShotOptions& one);
  void find_site(const ShotOptions& options);
  /// Of the shot as it is now: what an earlier call returned may be gone.
  ShotRun& run();

  std::unique_ptr<Session> session_;
  std::unique_ptr<ShotRun> run_;
  FarmShot site_;
  FarmSettings settings_;
  std::optional<FarmRecord> record_;
  std::vector<std::string> kept_sets_;
};

}  // namespace softreel
