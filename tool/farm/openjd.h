/// A shot's jobs as a job template of Open Job Description, specification version 2023-09, as JSON.
#pragma once

#include <string>
#include <vector>

#include "tool/farm/farm_settings.h"
#include "tool/farm/task_script.h"

namespace softreel {

/// A parameter takes at most 1024 values.
inline constexpr std::size_t kMostOpenJdTasks = 1024;

/// Steps with the plan's dependencies; a step of frames has a task parameter of frame ranges. What may lie elsewhere on
/// another machine (program, shot, output, cache) is a PATH parameter, so that path mapping reaches it. needs: of each
/// job. Throws input_error for paths that a template cannot carry: with control characters, or longer than 1024.
std::string openjd_template(const FarmShot& shot, const std::vector<FarmJob>& jobs,
                            const std::vector<FarmNeeds>& needs);

}  // namespace softreel
