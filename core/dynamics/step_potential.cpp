#include "core/dynamics/step_potential.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/dynamics/linear_system.h"

namespace softreel {
namespace {

/// About how far rounding may put (x - base)^T D (x - base) wrong: it is small for what moves rigidly, but a sum of
/// great numbers where that is stiff.
double find_noise(const BlockMatrixd& D, std::span<const Vec3> moves) {
  constexpr double kOtherBlocks = 2;  // those beside the diagonal, together about as large as it
  double square = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const double* const block = D.block(D.pattern.find(static_cast<Index>(i), static_cast<Index>(i)));
    const double term = std::max({block[0], block[4], block[8]}) * moves[i].squaredNorm();
    square += term * term;
  }
  return kOtherBlocks * std::numeric_limits<double>::epsilon() * std::sqrt(square);
}

}  // namespace

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
  if (!has_frozen_damping()) return energy;
  std::vector<Vec3> moves(positions.size()), product(positions.size());
  for (std::size_t i = 0; i < moves.size(); ++i) moves[i] = positions[i] - base_positions[i];
  multiply(frozen_damping, moves, product, threads);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    forces[i] -= product[i];
    energy.value += 0.5 * moves[i].dot(product[i]);
  }
  energy.noise += find_noise(frozen_damping, moves);
  return energy;
}

}  // namespace softreel
