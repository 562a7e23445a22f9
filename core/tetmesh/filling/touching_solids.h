/// Solids that touch without overlapping: they look joined, and are not.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/tetmesh/filling/solids.h"

namespace softreel {

/// Pairs of solids that come within a hundred-thousandth of their size of each other, in the order of the first. Solids
/// that overlap are one (find_solids); open ones are not looked at.
std::vector<std::array<Index, 2>> find_touching(const std::vector<Solid>& solids);

/// Warns of them: each is filled for itself, and nothing holds them together.
void warn_of_touching(const std::vector<Solid>& solids, const std::string& name, const Log& log);

}  // namespace softreel
