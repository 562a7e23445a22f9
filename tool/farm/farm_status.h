/// How the tasks of a submission fare: from what is there, what they said of themselves, and what the scheduler says.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tool/farm/farm_record.h"
#include "tool/farm/slurm_queue.h"

namespace softreel {

enum class TaskState {
  Done,  ///< what it makes is there
  Running,
  Waiting,
  Stuck,  ///< it waits for what does not come by itself
  Failed,
  Cancelled,  ///< it was taken from the queue before it ran: what it waited for failed, or somebody did so
  Lost        ///< it left the queue without a word, and what it makes is not there
};

const char* state_name(TaskState state);

struct TaskStatus {
  SubmittedTask task;
  TaskState state = TaskState::Waiting;
  std::string node;
  std::string why;  ///< of Stuck, Failed, Lost: on a line; of Waiting: Slurm's reason, if it gave one
};

/// Whether what a task makes is there.
using IsThere = std::function<bool(const SubmittedTask& task)>;
/// What a task said of itself.
using SaidOf = std::function<TaskRecord(const SubmittedTask& task)>;

/// queue: none where no scheduler can be asked; then what a task said last holds.
std::vector<TaskStatus> find_task_statuses(const FarmRecord& record, const std::optional<Queue>& queue,
                                           const IsThere& is_there, const SaidOf& said_of);

/// The line of a log that says best why a task failed; empty if there is none.
std::string telling_line(const std::string& log);

struct FarmSummary {
  int done = 0, running = 0, waiting = 0;
  int blocked = 0;  ///< of those that wait: they wait for other tasks
  int broken = 0;   ///< stuck, failed, cancelled or lost
  bool all_done() const { return running + waiting + broken == 0; }
  /// Nothing will happen any more by itself, and not all is done.
  bool has_stopped() const { return running == 0 && waiting == blocked && broken > 0; }
};
FarmSummary summarize(const std::vector<TaskStatus>& statuses);

/// A line per step, and per task that failed or is stuck one with what it said and its log. told: telling_line of
/// its log.
std::string status_text(const FarmRecord& record, const std::vector<TaskStatus>& statuses,
                        const std::function<std::string(const SubmittedTask&)>& told);
std::string status_json(const FarmRecord& record, const std::vector<TaskStatus>& statuses,
                        const std::function<std::string(const SubmittedTask&)>& told);

}  // namespace softreel
