/// What a body's pins and pulls follow, read from its files.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/constraints/followed_motion.h"
#include "core/mesh/scene_animation.h"
#include "tool/shot/shot.h"
#include "tool/stages/loaded_body.h"

namespace softreel {

/// Owns the motions that constraints refer to; they stay where they are when this moves.
class FollowedFiles {
 public:
  /// The motion that a constraint of the body asks for. A scene file is read once. Throws input_error for a file that
  /// cannot be read or holds no animation, for nodes, meshes and clips that it does not have, naming the nearest, and
  /// for vertices that are not as many as the body's where they must be.
  const FollowedMotion& motion(const Shot& shot, const FollowSettings& follow, const LoadedBody& body, const Log& log);

 private:
  const SceneAnimation& scene(const std::string& path, const Log& log);

  std::map<std::string, std::unique_ptr<const SceneAnimation>> scenes_;
  std::vector<std::unique_ptr<const FollowedMotion>> motions_;
};

}  // namespace softreel
