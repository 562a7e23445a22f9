/// What a clip says of the nodes and meshes that a pin or pull follows, checked.
#pragma once

#include <string>
#include <vector>

#include "core/constraints/followed_motion.h"
#include "core/mesh/scene_animation.h"

namespace softreel {

/// A clip as a constraint follows it.
struct FollowedClip {
  const std::string& file;
  const SceneAnimation& scene;
  const SceneClip& clip;
  std::vector<Index> meshes = {};  ///< numbers in the scene; empty: a node is followed
  SceneNodes nodes;                ///< all that the motion comes from
};

/// Throws input_error where a joint, or what the clip moves, is told by the name of several nodes: file formats name
/// them, so that it could be any.
void require_own_names(const FollowedClip& followed);

/// A warning where keys of different values stand so far apart that the file's format means a curve between them, which
/// assimp does not pass on; empty: there are none. fps: of the shot.
std::string straight_curve_warning(const FollowedClip& followed, double fps);

/// A warning where all keys come before or after the frames of the shot, with the start that would bring them in;
/// empty: some do not.
std::string still_clip_warning(const FollowedClip& followed, const ClipTiming& timing, int first_frame, int last_frame);

}  // namespace softreel
