#include "core/dynamics/rigid_modes.h"

#include <vector>

#include <Eigen/Cholesky>

namespace softreel {
namespace {

/// Mass, first moments and momenta of a piece.
struct RigidSums {
  double mass = 0;
  Vec3 center = Vec3::Zero(), momentum = Vec3::Zero(), angular = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
  Vec3 spin = Vec3::Zero();  ///< angular velocity of the rigid part
};

}  // namespace

void remove_rigid_motion(const Pieces& pieces, std::span<const std::uint8_t> held, std::span<const double> masses,
                         std::span<const Vec3> positions, std::span<Vec3> motion) {
  std::vector<RigidSums> sums(held.size());
  const auto piece = [&](std::size_t i) { return static_cast<std::size_t>(pieces.of_node[i]); };
  for (std::size_t i = 0; i < motion.size(); ++i) {
    RigidSums& sum = sums[piece(i)];
    sum.mass += masses[i];
    sum.center += masses[i] * positions[i];
    sum.momentum += masses[i] * motion[i];
  }
  for (RigidSums& sum : sums) {
    sum.center /= sum.mass;
    sum.momentum /= sum.mass;
  }
  for (std::size_t i = 0; i < motion.size(); ++i) {
    RigidSums& sum = sums[piece(i)];
    const Vec3 arm = positions[i] - sum.center;
    sum.angular += masses[i] * arm.cross(motion[i]);
    sum.inertia += masses[i] * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
  for (RigidSums& sum : sums) sum.spin = sum.inertia.ldlt().solve(sum.angular);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const RigidSums& sum = sums[piece(i)];
    if (held[piece(i)] != 0) continue;
    motion[i] -= sum.momentum;
    if (sum.spin.allFinite()) motion[i] -= sum.spin.cross(positions[i] - sum.center);
  }
}

}  // namespace softreel
