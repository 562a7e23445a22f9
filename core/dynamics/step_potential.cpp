#include "core/dynamics/step_potential.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/dynamics/linear_system.h"

namespace softreel {

double StepPotential::evaluate(std::span<const Vec3> positions, std::span<Vec3> forces, const Threads& threads) const {
  double energy = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 away = positions[i] - centers[i];
    forces[i] = -weights[i] * away;
    energy += 0.5 * weights[i] * away.squaredNorm();
  }
  if (!has_damping_stiffness()) return energy;
  std::vector<Vec3> moves(positions.size()), product(positions.size());
  for (std::size_t i = 0; i < moves.size(); ++i) moves[i] = positions[i] - base_positions[i];
  multiply(damping_stiffness, moves, product, threads);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    forces[i] -= product[i];
    energy += 0.5 * moves[i].dot(product[i]);
  }
  return energy;
}

double StepPotential::energy_noise(std::span<const Vec3> positions) const {
  if (!has_damping_stiffness()) return 0;
  constexpr double kOtherBlocks = 2;  // those beside the diagonal, together about as large as it
  double square = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto row = static_cast<Index>(i);
    const double* const block = damping_stiffness.block(damping_stiffness.pattern.find(row, row));
    const double term = std::max({block[0], block[4], block[8]}) * (positions[i] - base_positions[i]).squaredNorm();
    square += term * term;
  }
  return kOtherBlocks * std::numeric_limits<double>::epsilon() * std::sqrt(square);
}

}  // namespace softreel
