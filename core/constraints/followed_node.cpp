#include "core/constraints/followed_node.h"

#include <cmath>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {
namespace {

/// A volume below this share of what its axes could span is that of a flat node.
constexpr double kFlatNode = 1e-12;

}  // namespace

FollowedNode::FollowedNode(const SceneAnimation& scene, const SceneClip& clip, Index node, const ClipTiming& timing,
                           std::optional<double> reference_frame, const Placement& placement)
    : path_(scene, &clip, {node}), timing_(timing), placement_(placement) {
  reference_ =
      reference_frame ? node_at(timing.seconds(*reference_frame)) : SceneNodes(scene, nullptr, {node}).at(0).back();
  const Mat3& axes = reference_.linear;
  if (!(std::abs(axes.determinant()) > kFlatNode * axes.col(0).norm() * axes.col(1).norm() * axes.col(2).norm()))
    throw input_error(
        fmt::format("node '{}' has no extent {}, so that its motion from there cannot be told.\n  Accepted: a node of "
                    "a scale that is not 0. Choose another reference frame.",
                    scene.nodes[static_cast<std::size_t>(node)].name,
                    reference_frame ? fmt::format("at frame {}", *reference_frame) : "in the file's rest pose"));
}

std::vector<LocalMotion> FollowedNode::motions(std::span<const FollowTie>, double frame) const {
  const Affine now = node_at(timing_.seconds(frame));
  LocalMotion motion;
  motion.from = placement_(reference_.offset);
  motion.to = placement_(now.offset);
  if (now.linear != reference_.linear)
    motion.linear = placement_.linear * now.linear * reference_.linear.inverse() * placement_.linear.inverse();
  return {motion};
}

std::vector<double> FollowedNode::pose(double frame) const {
  const LocalMotion motion = motions({}, frame).front();
  std::vector<double> numbers(motion.linear.data(), motion.linear.data() + 9);
  for (const Vec3& v : {motion.from, motion.to}) numbers.insert(numbers.end(), v.data(), v.data() + 3);
  return numbers;
}

}  // namespace softreel
