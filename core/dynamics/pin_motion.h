/// How held nodes get to new places, and how a body follows them before anything is solved.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/dynamics/pieces.h"

namespace softreel {

/// p -> to + rotation (p - from).
struct RigidMotion {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  Quaternion rotation = Quaternion::Identity();
  Index points = 0;  ///< that it was fitted to
};

/// For each group, the rigid motion that carries its held nodes from `positions` nearest to `targets` in the mean. Ties
/// (held nodes on a line, say) turn the least. held, positions, targets: per node.
std::vector<RigidMotion> fit_rigid_motions(const Pieces& groups, std::span<const std::uint8_t> held,
                                           std::span<const Vec3> positions, std::span<const Vec3> targets);

/// Moves every piece by its fitted motion, so that a rigid motion of all its pins by any angle moves it rigidly.
/// rotations: per element, turned along.
void follow_rigidly(const Pieces& pieces, std::span<const std::uint8_t> held, std::span<const Vec3> targets,
                    const std::vector<Tet>& tets, std::span<Vec3> positions, std::span<Quaternion> rotations);

/// False if every held node is at its target, but for what rounding leaves of a rigid motion.
bool held_nodes_move(std::span<const std::uint8_t> held, std::span<const Vec3> positions,
                     std::span<const Vec3> targets);

/// The way of held nodes from their positions to their targets, for load stepping: each cluster of them that elements
/// connect turns and moves as a whole, and what its rigid motion leaves over grows linearly. A pin that turns does not
/// shrink on the way.
class HeldMotion {
 public:
  HeldMotion(const std::vector<Tet>& tets, std::span<const std::uint8_t> held, std::span<const Vec3> positions,
             std::span<const Vec3> targets);

  bool moves() const;  ///< held_nodes_move at the start
  /// Places of the held nodes after `share` of the way; exactly the targets at 1. Zero elsewhere.
  std::vector<Vec3> at(double share) const;

 private:
  Pieces clusters_;
  std::vector<RigidMotion> motions_;  ///< per cluster
  std::vector<Vec3> start_, targets_;
};

}  // namespace softreel
