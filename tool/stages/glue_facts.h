/// What `softreel check` says of glue.
#pragma once

#include <string>
#include <vector>

#include "tool/stages/shot_run.h"

namespace softreel {

/// A line for each glue of the shot: how many points may stick, and how near the nearest is where the bodies rest.
std::vector<std::string> glue_facts(const ShotRun& run);

}  // namespace softreel
