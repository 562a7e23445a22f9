/// What a user says of a submission: sizes of tasks, and what they ask of the scheduler and its nodes.
#pragma once

#include <string>
#include <vector>

#include "tool/farm/farm_plan.h"

namespace softreel {

/// As given on the command line, and kept with the submission so that a retry asks for the same. Empty and 0: not
/// given.
struct FarmSettings {
  std::string name;          ///< of the jobs
  int chunk = 0;             ///< frames of a task
  int cpus = 0;              ///< of a task
  std::string memory, time;  ///< of a task: see parse_memory, parse_time
  std::string partition, account, constraint;
  std::vector<std::string> sbatch;  ///< further arguments of sbatch
  std::string program;              ///< softreel on the nodes
};

/// What is given wins over what was given before.
FarmSettings merged(FarmSettings before, const FarmSettings& given);

/// Bytes of "4G", "500M", "2T", "800K" or megabytes without a letter, as Slurm reads them. Throws input_error.
double parse_memory(const std::string& text);

/// Seconds of Slurm's forms of a time limit: MINUTES, MINUTES:SECONDS, HOURS:MINUTES:SECONDS,
/// DAYS-HOURS[:MINUTES[:SECONDS]]. Throws input_error.
double parse_time(const std::string& text);

/// What the figures of a plan's estimate were measured with.
inline constexpr int kDefaultTaskCpus = 2;

/// What a task asks of its node.
struct FarmNeeds {
  int cpus = 1;
  double bytes = 0;
  double seconds = 0;  ///< after which it is ended
};

/// What the plan of a shot expects, within a factor of two on the machine that it was measured on.
struct FarmEstimate {
  double bytes = 0;
  double fill_seconds = 0, simulate_seconds = 0;
  double frame_seconds = 0;  ///< of one picture
};

/// Frames of a task where the user gives none: about five minutes by the estimate, but at least eight tasks if there
/// are frames enough, so that several nodes have work.
int default_chunk(const FarmEstimate& estimate, int frames);

/// What is given, and otherwise twice the memory of the estimate and 1 GiB, and six times its time and half an hour:
/// estimates are coarse, nodes differ, and a limit is there to end what hangs.
FarmNeeds needs_of(const FarmJob& job, const FarmEstimate& estimate, const FarmSettings& settings);

}  // namespace softreel
