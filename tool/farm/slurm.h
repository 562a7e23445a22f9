/// A shot's jobs for Slurm: scripts, and the command lines that submit them.
#pragma once

#include <string>
#include <vector>

#include "tool/farm/farm_settings.h"
#include "tool/farm/task_script.h"

namespace softreel {

/// Slurm takes arrays of at most MaxArraySize - 1 tasks, 1000 where nobody changed it.
inline constexpr std::size_t kMostSlurmTasks = 1000;

/// The batch script of a job; of an array the same for all tasks, which find their frames by SLURM_ARRAY_TASK_ID.
std::string slurm_script(const FarmShot& shot, const FarmJob& job, const FarmNeeds& needs);

/// The arguments that submit the script. after: the scheduler's names of jobs or tasks that must have succeeded; if one
/// fails, Slurm cancels the job. Throws input_error for a folder in which Slurm cannot write logs.
std::vector<std::string> sbatch_command(const FarmShot& shot, const FarmJob& job, const FarmNeeds& needs,
                                        const FarmSettings& settings, const std::vector<std::string>& after,
                                        const std::string& script_path);

/// The job's number in what `sbatch --parsable` printed. Throws work_error if it is none.
std::string submitted_job(const std::string& said);

/// Slurm's name of a job's task: "12", of an array "12_3".
std::string slurm_task(const FarmJob& job, const std::string& job_number, std::size_t task);
/// The name of its log file.
std::string slurm_log(const FarmJob& job, const std::string& slurm_task);

}  // namespace softreel
