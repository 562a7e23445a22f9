/// The bash script of a farm's task: looks whether its node sees what the task needs, runs softreel, says how it ended.
#pragma once

#include <string>
#include <vector>

#include "tool/farm/farm_plan.h"

namespace softreel {

/// One shot as a farm's nodes see it. All paths are absolute.
struct FarmShot {
  std::string name;           ///< of the jobs
  std::string shot;           ///< its file
  std::string output, cache;  ///< folders that all nodes share
  std::string records;        ///< folder in `output`: what tasks say of themselves, logs, scripts
  std::string token;  ///< file in records and, with a dot before it, in cache: a node that lacks it sees another disk
  std::string directory;                   ///< where relative paths in `sets` start from
  std::vector<std::string> sets;           ///< "path=value"
  double cache_limit_gb = -1;              ///< below 0: none
  std::string program, version, checksum;  ///< softreel on the nodes: "softreel 1.2.3", SHA-256
};

/// Where tasks say how they fare: first line the state (running, done, failed), then node, exit status, name of the
/// log, time, name of the job.
std::string record_path(const FarmShot& shot, const std::string& task);
std::string log_folder(const FarmShot& shot);
/// The token's file in the cache.
std::string cache_token_path(const FarmShot& shot);

/// Variables of the script that the engine sets, each as a bash expression.
struct TaskVariables {
  std::string task;             ///< name of the task: task_name
  std::string job, log;         ///< the scheduler's name of the task; its log's file name
  std::string frames, threads;  ///< "FIRST-LAST"; a number
  bool keeps_log = false;       ///< the scheduler keeps none: the script writes it
};

/// Assignments of all that the nodes must know of the shot.
std::string shot_assignments(const FarmShot& shot);
/// Assignments of the texts in --set, and of the cache's limit.
std::string set_assignment(const FarmShot& shot, FarmStep step);
std::string task_assignments(const TaskVariables& variables);
/// What follows the assignments.
std::string task_body(FarmStep step);

}  // namespace softreel
