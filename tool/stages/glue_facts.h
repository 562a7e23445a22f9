/// What `softreel check` says of glue.
#pragma once

#include <string>
#include <vector>

#include "tool/stages/shot_run.h"

namespace softreel {

struct GlueFacts {
  std::vector<std::string> lines;     ///< one a glue: how many points may stick, and how near the nearest is at rest
  std::vector<std::string> warnings;  ///< of glue that starts with the shot, where nothing is near enough to stick
};

GlueFacts glue_facts(const ShotRun& run);

}  // namespace softreel
