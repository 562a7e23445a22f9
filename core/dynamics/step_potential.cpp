#include "core/dynamics/step_potential.h"

namespace softreel {

DampingEnergy StepPotential::evaluate(const ElasticBody& body, std::span<const Vec3> positions,
                                      std::span<const Quaternion> rotations, std::span<Vec3> forces,
                                      const Threads& threads) const {
  DampingEnergy energy;
  if (damping.empty()) {
    for (Vec3& force : forces) force.setZero();
  } else {
    std::vector<Mat3> stresses(body.tets.size());
    energy = find_damping(body, damping, positions, rotations, stresses, threads);
    gather_forces(body, stresses, forces, threads);
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 away = positions[i] - centers[i];
    forces[i] -= weights[i] * away;
    energy.value += 0.5 * weights[i] * away.squaredNorm();
  }
  return energy;
}

}  // namespace softreel
