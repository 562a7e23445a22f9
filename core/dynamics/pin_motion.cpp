#include "core/dynamics/pin_motion.h"

#include "core/elasticity/element_rotation.h"

namespace softreel {
namespace {

/// p -> to + rotation (p - from).
struct RigidMotion {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  Quaternion rotation = Quaternion::Identity();
  Index points = 0;
};

/// The best motion of each piece; points = 0 where it holds none.
std::vector<RigidMotion> fit_motions(const Pieces& pieces, std::span<const std::uint8_t> held,
                                     std::span<const Vec3> targets, std::span<const Vec3> positions) {
  std::vector<RigidMotion> motions(static_cast<std::size_t>(pieces.count));
  std::vector<Mat3> moments(motions.size(), Mat3::Zero());
  const auto piece = [&](std::size_t i) { return static_cast<std::size_t>(pieces.of_node[i]); };
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == 0) continue;
    RigidMotion& motion = motions[piece(i)];
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
    const RigidMotion& motion = motions[piece(i)];
    moments[piece(i)] += (targets[i] - motion.to) * (positions[i] - motion.from).transpose();
  }
  for (std::size_t p = 0; p < motions.size(); ++p)
    motions[p].rotation = find_rotation(moments[p], Quaternion::Identity());
  return motions;
}

}  // namespace

void follow_rigidly(const Pieces& pieces, std::span<const std::uint8_t> held, std::span<const Vec3> targets,
                    std::span<Vec3> positions, std::span<Quaternion> rotations, const std::vector<Tet>& tets) {
  const std::vector<RigidMotion> motions = fit_motions(pieces, held, targets, positions);
  const auto piece = [&](Index node) {
    return static_cast<std::size_t>(pieces.of_node[static_cast<std::size_t>(node)]);
  };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const RigidMotion& motion = motions[piece(static_cast<Index>(i))];
    if (motion.points > 0) positions[i] = motion.to + motion.rotation * (positions[i] - motion.from);
  }
  for (std::size_t e = 0; e < tets.size(); ++e)
    rotations[e] = (motions[piece(tets[e][0])].rotation * rotations[e]).normalized();
}

}  // namespace softreel
