/// Fields that a shot sets and that nothing reads.
#pragma once

#include <string>
#include <vector>

#include "tool/shot/shot.h"

namespace softreel {

/// A line for each field of [shot], [solver] and [camera] that differs from its default while another one, named, takes
/// its effect.
std::vector<std::string> find_unused_fields(const Shot& shot);

}  // namespace softreel
