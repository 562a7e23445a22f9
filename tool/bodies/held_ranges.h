/// Ranges of frames in which a constraint is meant to hold but no step of time sees it.
#pragma once

#include <string>
#include <vector>

#include "core/constraints/constraints.h"
#include "tool/shot/shot.h"

namespace softreel {

/// A line for each range of `active` (of the pin, pull or glue called `name`) within the simulated frames in which no
/// step ends, and, of one that grabs, for each after whose first step none is held. One line where all ranges are out
/// of the simulated frames.
std::vector<std::string> find_missed_ranges(const Shot& shot, const std::string& name,
                                            const std::vector<FrameRange>& active, bool grab);

}  // namespace softreel
