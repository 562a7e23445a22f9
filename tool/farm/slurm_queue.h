/// What Slurm says of its jobs.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace softreel {

/// A task in the queue, or one that left it a short while ago.
struct QueueEntry {
  std::string state;   ///< Slurm's: "PENDING", "RUNNING", "TIMEOUT" ...
  std::string node;    ///< empty while it waits
  std::string reason;  ///< why it waits, or "None"
};

/// By Slurm's name of the task: "12", "12_3".
using Queue = std::map<std::string, QueueEntry>;

/// Lists the tasks of these users (numbers), at least one.
std::vector<std::string> squeue_command(const std::set<unsigned>& users);

/// Reads what squeue_command's program printed; lines of another form are left out.
Queue parse_queue(const std::string& said);

/// The task is still to run or running.
bool is_live(const QueueEntry& entry);

/// Why the task waits is nothing that passes by itself: its limits, its account, or what it asks of nodes.
bool is_hopeless(const QueueEntry& entry);

}  // namespace softreel
