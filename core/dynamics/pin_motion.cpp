#include "core/dynamics/pin_motion.h"

#include <algorithm>

#include "core/elasticity/element_rotation.h"

namespace softreel {
namespace {

/// Over the greatest coordinate: what rounding leaves of a rigid motion, which is none.
constexpr double kRounding = 1e-13;

}  // namespace

std::vector<RigidMotion> fit_rigid_motions(const Pieces& groups, std::span<const std::uint8_t> held,
                                           std::span<const Vec3> positions, std::span<const Vec3> targets) {
  std::vector<RigidMotion> motions(static_cast<std::size_t>(groups.count));
  std::vector<Mat3> moments(motions.size(), Mat3::Zero());
  const auto motion_of = [&](std::size_t i) -> RigidMotion& {
    return motions[static_cast<std::size_t>(groups.of_node[i])];
  };
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == 0) continue;
    RigidMotion& motion = motion_of(i);
    motion.from += positions[i];
    motion.to += targets[i];
    ++motion.points;
  }
  for (RigidMotion& motion : motions) {
    if (motion.points == 0) continue;
    motion.from /= motion.points;
    motion.to /= motion.points;
  }
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == 0) continue;
    const RigidMotion& motion = motion_of(i);
    moments[static_cast<std::size_t>(groups.of_node[i])] +=
        (targets[i] - motion.to) * (positions[i] - motion.from).transpose();
  }
  for (std::size_t k = 0; k < motions.size(); ++k)
    motions[k].rotation = find_rotation(moments[k], Quaternion::Identity());
  return motions;
}

void follow_rigidly(const Pieces& pieces, std::span<const std::uint8_t> held, std::span<const Vec3> targets,
                    const std::vector<Tet>& tets, std::span<Vec3> positions, std::span<Quaternion> rotations) {
  const std::vector<RigidMotion> motions = fit_rigid_motions(pieces, held, positions, targets);
  const auto motion_of = [&](std::size_t node) -> const RigidMotion& {
    return motions[static_cast<std::size_t>(pieces.of_node[node])];
  };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const RigidMotion& motion = motion_of(i);
    if (motion.points > 0) positions[i] = motion.to + motion.rotation * (positions[i] - motion.from);
  }
  for (std::size_t e = 0; e < tets.size(); ++e)
    rotations[e] = (motion_of(static_cast<std::size_t>(tets[e][0])).rotation * rotations[e]).normalized();
}

bool held_nodes_move(std::span<const std::uint8_t> held, std::span<const Vec3> positions,
                     std::span<const Vec3> targets) {
  double greatest = 0, farthest = 0;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == 0) continue;
    greatest = std::max({greatest, positions[i].cwiseAbs().maxCoeff(), targets[i].cwiseAbs().maxCoeff()});
    farthest = std::max(farthest, (targets[i] - positions[i]).cwiseAbs().maxCoeff());
  }
  return !(farthest <= kRounding * greatest);
}

HeldMotion::HeldMotion(const std::vector<Tet>& tets, std::span<const std::uint8_t> held,
                       std::span<const Vec3> positions, std::span<const Vec3> targets)
    : clusters_(find_pieces(tets, positions.size(), held)),
      motions_(fit_rigid_motions(clusters_, held, positions, targets)),
      start_(positions.begin(), positions.end()),
      targets_(targets.begin(), targets.end()) {}

bool HeldMotion::moves() const {
  std::vector<std::uint8_t> held;
  for (const Index cluster : clusters_.of_node) held.push_back(cluster >= 0 ? 1 : 0);
  return held_nodes_move(held, start_, targets_);
}

std::vector<Vec3> HeldMotion::at(double share) const {
  std::vector<Vec3> places(start_.size(), Vec3::Zero());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (clusters_.of_node[i] < 0) continue;
    const RigidMotion& motion = motions_[static_cast<std::size_t>(clusters_.of_node[i])];
    const Vec3 arm = start_[i] - motion.from;
    const Vec3 rest = motion.rotation.conjugate() * (targets_[i] - motion.to) - arm;
    const Quaternion turned = Quaternion::Identity().slerp(share, motion.rotation);
    places[i] = share == 1 ? targets_[i]
                           : Vec3(motion.from + share * (motion.to - motion.from) + turned * (arm + share * rest));
  }
  return places;
}

}  // namespace softreel
