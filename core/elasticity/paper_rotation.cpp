#include "core/elasticity/paper_rotation.h"

#include <cmath>

#include <Eigen/LU>

namespace softreel {
namespace {

/// Smallest pivot of a Hessian over the greatest one, below which it is made of round-off.
constexpr double kSingularPivot = 1e-14;

}  // namespace

std::optional<PaperState> step_paper_newton(const RotationEnergy& energy, const PaperState& state) noexcept {
  Eigen::Matrix<double, 5, 5> hessian = energy.hessian(state.q, state.multiplier);
  Eigen::Matrix<double, 5, 1> gradient = energy.gradient(state.q, state.multiplier);
  // The rows of eqs. (5) and (7) are in m^5, those of eqs. (6) and (8) have no unit: lambda is measured in `scale`, so
  // that the test for a singular matrix does not depend on the size of the element. The change of q is the same. A
  // scale of 0 leaves no finite result.
  const double scale = hessian.topLeftCorner<4, 4>().cwiseAbs().maxCoeff();
  hessian.topLeftCorner<4, 4>() /= scale;
  gradient.head<4>() /= scale;
  const Eigen::PartialPivLU<Eigen::Matrix<double, 5, 5>> factors(hessian);
  const Eigen::Matrix<double, 5, 1> pivots = factors.matrixLU().diagonal().cwiseAbs();
  if (!(pivots.minCoeff() > kSingularPivot * pivots.maxCoeff())) return std::nullopt;
  const Eigen::Matrix<double, 5, 1> change = factors.solve(gradient);
  const PaperState next{state.q - change.head<4>(), state.multiplier - scale * change[4]};
  if (!next.q.allFinite() || !std::isfinite(next.multiplier)) return std::nullopt;
  return next;
}

Quaternion find_paper_rotation(const TetNodes& rest, const TetNodes& deformed, const Quaternion& guess) noexcept {
  const RotationEnergy energy(rest, deformed);
  const Vec4 start(guess.w(), -guess.x(), -guess.y(), -guess.z());
  PaperState state{start, energy.multiplier(start)};
  for (int iteration = 0; iteration < kPaperIterations; ++iteration) {
    const std::optional<PaperState> next = step_paper_newton(energy, state);
    if (!next) return guess;
    const double change = (next->q - state.q).norm();
    state = *next;
    if (change <= kPaperTolerance) break;
  }
  const double length = state.q.norm();
  if (!(length > 0) || !std::isfinite(length)) return guess;
  const Vec4 q = state.q / (state.q.dot(start) < 0 ? -length : length);
  return {q[0], -q[1], -q[2], -q[3]};
}

}  // namespace softreel
