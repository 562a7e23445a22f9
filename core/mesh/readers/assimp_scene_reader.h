/// Animated scenes in the formats of assimp: an entry of that part.
#pragma once

#include <string>

#include "core/mesh/scene_animation.h"

namespace softreel::detail {

/// See import_scene. Throws input_error.
extern "C" [[gnu::visibility("default")]] SceneAnimation softreel_read_scene_with_assimp(const std::string& path);

}  // namespace softreel::detail
