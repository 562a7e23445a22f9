/// What is remembered of a shot's submissions, beside its output, so that any machine can ask how they fare.
#pragma once

#include <string>
#include <vector>

#include "tool/farm/farm_settings.h"
#include "tool/farm/task_script.h"

namespace softreel {

/// A task that the scheduler was given.
struct SubmittedTask {
  FarmStep step = FarmStep::Simulate;
  FrameChunk frames;
  std::string job;  ///< the scheduler's name: "12", "12_3"; empty: not known
  std::string log;  ///< name of the file in the log folder
};

struct FarmRecord {
  std::string engine;  ///< "slurm", "openjd"
  unsigned user = 0;   ///< who submitted: others may ask too
  FarmShot shot;
  FrameChunk frames;  ///< asked for
  FarmSettings settings;
  std::vector<SubmittedTask> tasks;  ///< of the last submission, and of earlier ones those that were still to run then
};

std::string to_json(const FarmRecord& record);

/// Throws input_error, naming `path`, if the text is no record.
FarmRecord parse_farm_record(const std::string& text, const std::string& path);

/// What a task said of itself: the file at record_path.
struct TaskRecord {
  std::string state;  ///< "running", "done", "failed"
  std::string node, log, time, job;
  int status = 0;
};

/// Nothing that is not whole counts: the state is empty then.
TaskRecord parse_task_record(const std::string& text);

}  // namespace softreel
