#include "tool/farm/farm_status.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace softreel {
namespace {

bool is_broken(TaskState state) {
  return state == TaskState::Stuck || state == TaskState::Failed || state == TaskState::Cancelled ||
         state == TaskState::Lost;
}

TaskStatus live_status(const SubmittedTask& task, const QueueEntry& entry) {
  if (is_hopeless(entry)) return {task, TaskState::Stuck, {}, "Slurm will never start it: " + entry.reason};
  if (entry.state == "PENDING" || entry.state.starts_with("REQUEUE"))
    return {task, TaskState::Waiting, {}, entry.reason};
  return {task, TaskState::Running, entry.node, {}};
}

/// Why Slurm ended a task, with the way out; empty if the task ended by itself, or nobody knows.
std::string slurm_reason(const QueueEntry* entry) {
  if (entry == nullptr || entry->state == "FAILED" || entry->state == "COMPLETED") return {};
  if (entry->state == "TIMEOUT") return "Slurm says TIMEOUT; --retry --time LIMIT gives it longer";
  if (entry->state == "OUT_OF_MEMORY") return "Slurm says OUT_OF_MEMORY; --retry --memory SIZE gives it more";
  return "Slurm says " + entry->state;
}

/// A task that is in no queue any more and whose results are not there.
TaskStatus ended_status(const SubmittedTask& task, const QueueEntry* entry, const TaskRecord& said) {
  const std::string node = !said.node.empty() ? said.node : entry != nullptr ? entry->node : "";
  if (entry != nullptr && entry->state == "CANCELLED" && said.state.empty())
    return {task, TaskState::Cancelled, {}, {}};
  // A task that Slurm ends says that it was interrupted, which is less.
  if (const std::string reason = slurm_reason(entry); !reason.empty()) return {task, TaskState::Failed, node, reason};
  if (said.state == "failed") return {task, TaskState::Failed, node, fmt::format("exit status {}", said.status)};
  if (entry != nullptr && entry->state == "COMPLETED")
    return {task, TaskState::Lost, node, "it ended well, but what it made is not there: is the output folder shared?"};
  if (entry != nullptr) return {task, TaskState::Failed, node, "Slurm says " + entry->state};
  if (said.state == "done") return {task, TaskState::Lost, node, "what it made is not there any more"};
  return {task, TaskState::Lost, node, "it is not in the queue any more"};
}

TaskStatus status_of(const SubmittedTask& task, const std::optional<Queue>& queue, bool there, const TaskRecord& said) {
  if (there) return {task, TaskState::Done, said.node, {}};
  if (queue) {
    const auto entry = queue->find(task.job);
    const bool known = entry != queue->end();
    return known && is_live(entry->second) ? live_status(task, entry->second)
                                           : ended_status(task, known ? &entry->second : nullptr, said);
  }
  if (said.state == "running") return {task, TaskState::Running, said.node, {}};
  if (said.state.empty()) return {task, TaskState::Waiting, {}, {}};
  return ended_status(task, nullptr, said);
}

/// "3 done, 2 running"
std::string counts_text(const std::vector<TaskStatus>& statuses, FarmStep step) {
  constexpr std::array kOrder{TaskState::Done,   TaskState::Running,   TaskState::Waiting, TaskState::Stuck,
                              TaskState::Failed, TaskState::Cancelled, TaskState::Lost};
  std::string text;
  for (const TaskState state : kOrder) {
    const auto count = std::count_if(statuses.begin(), statuses.end(), [&](const TaskStatus& status) {
      return status.task.step == step && status.state == state;
    });
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, state_name(state));
  }
  return text;
}

std::string shown_task(const SubmittedTask& task) {
  if (task.step != FarmStep::Frames) return step_name(task.step);
  return task.frames.count() == 1 ? fmt::format("frame {}", task.frames.first)
                                  : fmt::format("frames {}-{}", task.frames.first, task.frames.last);
}

}  // namespace

const char* state_name(TaskState state) {
  switch (state) {
    case TaskState::Done:
      return "done";
    case TaskState::Running:
      return "running";
    case TaskState::Waiting:
      return "waiting";
    case TaskState::Stuck:
      return "stuck";
    case TaskState::Failed:
      return "failed";
    case TaskState::Cancelled:
      return "cancelled";
    case TaskState::Lost:
      return "lost";
  }
  return "";
}

std::vector<TaskStatus> find_task_statuses(const FarmRecord& record, const std::optional<Queue>& queue,
                                           const IsThere& is_there, const SaidOf& said_of) {
  std::vector<TaskStatus> statuses;
  for (const SubmittedTask& task : record.tasks)
    statuses.push_back(status_of(task, queue, is_there(task), said_of(task)));
  return statuses;
}

std::string telling_line(const std::string& log) {
  std::string said, error, last;
  for (std::size_t begin = 0; begin < log.size();) {
    const std::size_t end = std::min(log.find('\n', begin), log.size());
    const std::string line = log.substr(begin, end - begin);
    begin = end + 1;
    if (line.empty()) continue;
    last = line;
    // The task's own closing line says only that it failed.
    const bool closing = line.starts_with("softreel farm: ") && line.find(" failed on node ") != std::string::npos;
    // Nor does the word of a softreel that was ended say by whom: Slurm's line does.
    const bool ended = line.starts_with("softreel: Interrupted");
    const bool ours = line.starts_with("softreel: ") || line.starts_with("softreel farm: ");
    const bool of_slurm = line.starts_with("slurmstepd") && line.find("error: ") != std::string::npos;
    if (of_slurm || (ours && !closing && !ended)) said = line;
    if (line.find("error: ") != std::string::npos) error = line;
  }
  return !said.empty() ? said : !error.empty() ? error : last;
}

FarmSummary summarize(const std::vector<TaskStatus>& statuses) {
  FarmSummary summary;
  for (const TaskStatus& status : statuses) {
    summary.done += status.state == TaskState::Done ? 1 : 0;
    summary.running += status.state == TaskState::Running ? 1 : 0;
    summary.waiting += status.state == TaskState::Waiting ? 1 : 0;
    summary.blocked += status.state == TaskState::Waiting && status.why == "Dependency" ? 1 : 0;
    summary.broken += is_broken(status.state) ? 1 : 0;
  }
  return summary;
}

std::string status_text(const FarmRecord& record, const std::vector<TaskStatus>& statuses,
                        const std::function<std::string(const SubmittedTask&)>& told) {
  std::string text;
  for (const FarmStep step : {FarmStep::Simulate, FarmStep::Frames, FarmStep::Movie}) {
    const std::string counts = counts_text(statuses, step);
    if (!counts.empty()) text += fmt::format("  {:9} {}\n", step_name(step), counts);
  }
  for (const TaskStatus& status : statuses) {
    if (!is_broken(status.state) || status.state == TaskState::Cancelled) continue;
    text += fmt::format("  {} {}{}: {}\n", shown_task(status.task), state_name(status.state),
                        status.node.empty() ? "" : " on node " + status.node, status.why);
    if (status.state == TaskState::Stuck) continue;  // it never ran: there is no log
    const std::string line = told(status.task);
    if (!line.empty()) text += fmt::format("    {}\n", line);
    if (!status.task.log.empty()) text += fmt::format("    log: {}/{}\n", log_folder(record.shot), status.task.log);
  }
  const bool cancelled = std::any_of(statuses.begin(), statuses.end(),
                                     [](const TaskStatus& s) { return s.state == TaskState::Cancelled; });
  if (cancelled) text += "  What is cancelled waited for tasks that failed, or was taken from the queue.\n";
  return text;
}

std::string status_json(const FarmRecord& record, const std::vector<TaskStatus>& statuses,
                        const std::function<std::string(const SubmittedTask&)>& told) {
  nlohmann::ordered_json tasks = nlohmann::ordered_json::array();
  for (const TaskStatus& status : statuses) {
    nlohmann::ordered_json json{{"step", step_name(status.task.step)},
                                {"frames", {status.task.frames.first, status.task.frames.last}},
                                {"job", status.task.job},
                                {"state", state_name(status.state)},
                                {"node", status.node}};
    if (is_broken(status.state)) {
      json["why"] = status.why;
      json["said"] = status.state == TaskState::Stuck ? std::string() : told(status.task);
    }
    if (!status.task.log.empty()) json["log"] = log_folder(record.shot) + "/" + status.task.log;
    tasks.push_back(std::move(json));
  }
  const FarmSummary summary = summarize(statuses);
  const nlohmann::ordered_json json{{"shot", record.shot.shot},
                                    {"engine", record.engine},
                                    {"output", record.shot.output},
                                    {"cache", record.shot.cache},
                                    {"done", summary.all_done()},
                                    {"stopped", summary.has_stopped()},
                                    {"tasks", tasks}};
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace softreel
