/// What a body's pins and pulls follow, read from its files.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/constraints/followed_motion.h"
#include "core/mesh/placement.h"
#include "core/mesh/point_cache.h"
#include "core/mesh/scene_animation.h"
#include "tool/bodies/followed_clip.h"
#include "tool/bodies/loaded_body.h"
#include "tool/shot/shot.h"

namespace softreel {

/// Owns the motions that constraints refer to; they stay where they are when this moves.
class FollowedFiles {
 public:
  /// The motion that a constraint of the body asks for. A file is read once. Says, once, where a clip holds still in
  /// the whole shot, and where its curves are taken as straight lines. Throws input_error for a file that cannot be
  /// read or holds no animation, for nodes, meshes and clips that it does not have, naming the nearest, or whose name
  /// does not tell which, and for vertices that are not as many as the body's where they must be.
  const FollowedMotion& motion(const Shot& shot, const FollowSettings& follow, const LoadedBody& body, const Log& log);

 private:
  const SceneAnimation& scene(const std::string& path, const Log& log);
  std::unique_ptr<const FollowedMotion> follow_cache(const Shot& shot, const FollowSettings& follow,
                                                     const LoadedBody& body, const ClipTiming& timing,
                                                     const Placement& placement);
  void check(const Shot& shot, const FollowedClip& clip, const ClipTiming& timing, const Log& log);

  std::map<std::string, std::unique_ptr<const SceneAnimation>> scenes_;
  std::map<std::string, std::shared_ptr<const CachedVertices>> caches_;
  std::vector<std::unique_ptr<const FollowedMotion>> motions_;
  std::set<std::string> said_;  ///< warnings, also of what other constraints follow
};

}  // namespace softreel
