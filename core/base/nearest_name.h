/// What the user may have meant: the known name nearest to an unknown one.
#pragma once

#include <string>
#include <vector>

namespace softreel {

/// The known name with the fewest edits (insert, delete, replace a letter, swap two neighbours; upper and lower case
/// are the same) from `unknown`, the first of several; empty if none is within a third of its length, at least one
/// edit.
std::string nearest_name(const std::string& unknown, const std::vector<std::string>& known);

}  // namespace softreel
