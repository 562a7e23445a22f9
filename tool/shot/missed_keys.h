/// Keys that are meant to move something and lie before the shot.
#pragma once

#include <string>
#include <vector>

#include "tool/shot/shot.h"

namespace softreel {

/// A line for each field whose keys differ and all lie before the shot's first frame (of what is simulated: before the
/// first of the preroll): it stands still. Keys after its last frame are what a shot that is cut short has.
std::vector<std::string> find_missed_keys(const Shot& shot);

}  // namespace softreel
