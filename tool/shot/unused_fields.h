/// Fields that a shot sets and that nothing reads.
#pragma once

#include <string>
#include <vector>

#include "tool/shot/shot.h"

namespace softreel {

/// A line for each field that differs from its default while another one, named, takes its effect, or what it is of is
/// not there.
std::vector<std::string> find_unused_fields(const Shot& shot);

}  // namespace softreel
