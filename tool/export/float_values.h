/// Numbers as float32 files hold them: the nearest one of each double, or an error that says whose it would be.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Appends x, y, z of each vector. Throws work_error if one is not finite in float32, naming `where` and the vertex:
/// readers of such files show such frames as garbage without a word.
void append_floats(const std::string& where, std::span<const Vec3> values, std::vector<float>& floats);

}  // namespace softreel
