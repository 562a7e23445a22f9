/// How a Newton direction becomes a better state: StaticSolver::step_along and what it is made of.
#include <algorithm>
#include <cmath>

#include "core/dynamics/inner_product.h"
#include "core/dynamics/static_solver.h"

namespace softreel {
namespace {

constexpr double kArmijo = 1e-4;      ///< share of the promised decrease of energy that a step must reach
constexpr int kHalvings = 16;         ///< of a step in the line search
constexpr double kLongestStep = 256;  ///< times the full step, where the tangent has negative curvature
constexpr int kStepsAhead = 4;        ///< full ones in a row, of which only the last must have improved

}  // namespace

/// One Newton step. An unfinished solve with the exact tangent may point nowhere although it descends at first: then
/// the positive part has another try.
bool StaticSolver::step_along(StaticState& state, double tolerance, bool has_direction, std::vector<Vec3>& direction) {
  if (has_direction && (search_ahead(state, tolerance, direction) || search_line(state, direction))) return true;
  if (unstable_ || !has_energy(parts_.params.rotation)) return false;
  return find_stable_direction(state, tolerance, direction) && search_line(state, direction);
}

bool StaticSolver::improves(const StaticState& from, const StaticState& to, double step, double slope) const {
  if (!std::isfinite(to.residual) || !std::isfinite(to.energy)) return false;
  // eq. (3)'s rotation, for one, has no energy: there only the residual can tell.
  if (!has_energy(parts_.params.rotation)) return to.residual < (1 - kArmijo * step) * from.residual;
  if (to.energy <= from.energy - kArmijo * step * slope) return true;
  return to.energy <= from.energy + std::max(from.energy_noise, to.energy_noise) && to.residual < from.residual;
}

StaticState StaticSolver::moved(const StaticState& state, std::span<const Vec3> direction, double step) {
  StaticState next{state.positions, state.rotations, {}};
  for (std::size_t i = 0; i < direction.size(); ++i) next.positions[i] += step * direction[i];
  evaluate(next);
  return next;
}

/// The watchdog of Chamberlain, Powell, Lemarechal and Pedersen (1982): full steps may lead uphill for a while if they
/// end below. A stiff part that turns by w along a straight line is strained by w^2 / 2, which the next step takes back
/// by turning on; a search along the line would never turn it farther than its stiffness to the power -1/3. Each
/// failure doubles the iterations until the next try. In statics, which may have far to go, only where parts are so
/// much stiffer than others that they hardly do anything but turn.
bool StaticSolver::search_ahead(StaticState& state, double tolerance, std::span<const Vec3> direction) {
  if (!(potential_ != nullptr || has_rigid_parts()) || unstable_ || !has_energy(parts_.params.rotation)) return false;
  if (iterations_ < next_ahead_) return false;
  const double slope = dot(direction, state.forces);
  StaticState next = moved(state, direction, 1);
  std::vector<Vec3> onward(direction.size());
  for (int step = 1; std::isfinite(next.residual); ++step) {
    if (improves(state, next, 1, slope)) {
      state = std::move(next);
      return true;
    }
    if (step == kStepsAhead) break;
    ++iterations_;
    if (!find_direction(next, tolerance, onward)) break;
    next = moved(next, onward, 1);
  }
  unstable_ = false;
  ahead_pause_ *= 2;
  next_ahead_ = iterations_ + ahead_pause_;
  return false;
}

/// Halves the step until it improves. Where the exact tangent has negative curvature (a body about to buckle) the full
/// step of its positive part is far too short, so there it is doubled as long as the energy falls.
bool StaticSolver::search_line(StaticState& state, std::span<const Vec3> direction) {
  const double slope = dot(direction, state.forces);
  double step = 1;
  for (int halving = 0; halving <= kHalvings; ++halving, step *= 0.5) {
    StaticState next = moved(state, direction, step);
    if (!improves(state, next, step, slope)) continue;
    while (unstable_ && step >= 1 && step < kLongestStep) {
      StaticState farther = moved(state, direction, 2 * step);
      if (!(farther.energy < next.energy)) break;
      next = std::move(farther);
      step *= 2;
    }
    state = std::move(next);
    return true;
  }
  return false;
}

}  // namespace softreel
