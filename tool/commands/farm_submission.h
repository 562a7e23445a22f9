/// What of a shot is submitted, and how.
#pragma once

#include <string>
#include <vector>

#include "tool/commands/farmed_shot.h"

namespace softreel {

/// Jobs for what is missing of a shot, less what tasks that are still in the queue will make.
struct FarmPlan {
  std::vector<FarmJob> jobs;
  std::vector<FarmNeeds> needs;         ///< of each job
  std::vector<SubmittedTask> kept;      ///< tasks in the queue, which go on
  std::vector<SubmittedTask> replaced;  ///< in the queue: jobs take their place
};

/// statuses: of the shot's record, empty if nothing is in the queue.
FarmPlan plan_submission(FarmedShot& shot, const std::vector<TaskStatus>& statuses, std::size_t most_tasks);

/// Submits the plan to Slurm. If sbatch refuses a job, those submitted before are cancelled. Throws work_error.
void submit_to_slurm(FarmedShot& shot, const FarmPlan& plan);
/// What submit_to_slurm would submit, as a person reads it.
std::string slurm_preview(const FarmedShot& shot, const FarmPlan& plan);

/// Writes the template. Returns its path.
std::string write_openjd(FarmedShot& shot, const FarmPlan& plan, const std::string& path);

/// What is in Slurm's queue of these users. Throws work_error if it cannot be asked.
Queue ask_slurm(const std::set<unsigned>& users);

}  // namespace softreel
