/// Animated scenes (glTF, FBX, Collada, ...) through assimp.
#pragma once

#include <string>

#include "core/base/log.h"
#include "core/mesh/scene_animation.h"

namespace softreel {

/// Nodes, clips, skins and morph targets of a file, in its own axes and unit; meshes in the order of import_mesh.
///
/// What assimp does not pass on of glTF is said in a warning: curves that step or are splines count as straight between
/// their keys. Two keys at one time are a step. Throws input_error for a file that cannot be read or contradicts
/// itself, and where assimp is not built in.
SceneAnimation import_scene(const std::string& path, const Log& log);

}  // namespace softreel
