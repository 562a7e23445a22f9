/// The files that a shot reads.
#pragma once

#include <string>
#include <vector>

#include "tool/shot/shot.h"

namespace softreel {

/// Meshes, tetrahedra, weights, what is followed, textures and surroundings, and the shot itself; as the shot names
/// them, resolved.
std::vector<std::string> files_read(const Shot& shot);

}  // namespace softreel
