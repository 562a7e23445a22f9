/// Which known name a misspelt one was meant to be.
#pragma once

#include <string>
#include <vector>

namespace softreel {

/// The known name with the fewest letters to change (Levenshtein distance, letter case ignored; the first of equals);
/// empty if none is near: more than a third of its letters, but at least two, would change.
std::string nearest_name(const std::string& unknown, const std::vector<std::string>& known);

}  // namespace softreel
