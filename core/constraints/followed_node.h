/// A node of a scene as what points follow: they move rigidly (or as the node's scale says) with it.
#pragma once

#include <optional>
#include <string>

#include "core/constraints/followed_motion.h"
#include "core/mesh/placement.h"
#include "core/mesh/scene_animation.h"

namespace softreel {

/// The node's map to the scene at a frame times the inverse of that at the reference, both placed.
class FollowedNode : public FollowedMotion {
 public:
  /// scene, clip: kept by reference. reference_frame: none for the pose that the file shows without a clip.
  /// Throws input_error if the node is flat at the reference, so that nothing can be said relative to it.
  FollowedNode(const SceneAnimation& scene, const SceneClip& clip, Index node, const ClipTiming& timing,
               std::optional<double> reference_frame, const Placement& placement);

  std::vector<FollowTie> tie(std::span<const Vec3>, std::span<const Index>) const override { return {}; }
  std::vector<LocalMotion> motions(std::span<const FollowTie> ties, double frame) const override;
  std::vector<double> pose(double frame) const override;
  std::uint64_t content() const override { return 0; }  // the pose is all there is

 private:
  Affine node_at(double seconds) const { return path_.at(seconds).back(); }

  SceneNodes path_;  ///< from the root to the node, which is the last: nodes stand before their children
  ClipTiming timing_;
  Placement placement_;
  Affine reference_;
};

}  // namespace softreel
