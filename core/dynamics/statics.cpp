#include <algorithm>

#include "core/base/error.h"
#include "core/dynamics/holding.h"
#include "core/dynamics/pin_motion.h"
#include "core/dynamics/static_solver.h"

namespace softreel {
namespace {

/// Newton iterations before a load step is halved, and the tolerance of those that are not the last.
constexpr int kStepIterations = 30;
constexpr double kStepTolerance = 1e-3;
constexpr double kSmallestLoadStep = 1.0 / 256;
constexpr double kStepGrowth = 1.5;

/// Iterations add up; status and residual are those of the last part.
void report_step(SolveReport& total, const SolveReport& step) {
  const int iterations = total.iterations + step.iterations;
  total = step;
  total.iterations = iterations;
}

/// Equilibrium with the held nodes at the end of their motion, in smaller moves where one is too much.
SolveReport solve_in_steps(const Simulator::Parts& parts, StaticSolver& solver, StaticState& state,
                           const HeldMotion& motion) {
  double done = 0, step = 1;
  SolveReport total;
  while (true) {
    const double reached = std::min(1.0, done + step);
    const bool last = reached == 1;
    StaticState next{state.positions, state.rotations, {}};
    const int left = parts.params.max_newton_iterations - solver.iterations();
    // A first, full move shows by kStepIterations whether it works; what remains of the limit is for smaller ones.
    const bool may_halve = motion.moves() && !(last && done > 0);
    const int allowed = std::max(0, may_halve ? std::min(left, kStepIterations) : left);
    const SolveReport report =
        solver.solve(next, motion.at(reached), last ? parts.params.force_tolerance : kStepTolerance, allowed);
    report_step(total, report);
    if (report.ok()) {
      state = std::move(next);
      if (last) return total;
      done = reached;
      step *= kStepGrowth;
      continue;
    }
    step *= 0.5;
    if (step < kSmallestLoadStep || left <= 0 || !motion.moves()) {
      state = std::move(next);
      return total;
    }
  }
}

}  // namespace

StepReport Simulator::Parts::find_equilibrium(double frame) {
  coarse_lag.usable = false;
  known_rest.known = false;
  Grabs grabs = grabs_at(frame);
  const PinnedNodes pinned = pins.at(frame, grabs.pins);
  std::vector<GlueBond> bonds = bonds_at(frame);
  join(bonds);
  const std::vector<ActivePull> pulls = pulls_at(frame, grabs, bonds);
  if (!pinned.conflict.empty()) throw input_error(pinned.conflict);
  StepReport report;
  const std::vector<std::uint8_t> held = held_pieces(pinned, pulls);
  check_holding(*this, held, pinned, pulls, frame);
  StaticState next{state.positions, state.rotations, {}};
  follow_rigidly(pieces, pinned.held, pinned.targets, body.tets, next.positions, next.rotations);
  const HeldMotion motion(body.tets, pinned.held, next.positions, pinned.targets);
  StaticSolver solver(*this, pinned.held, held, pulls);
  report.solve = solve_in_steps(*this, solver, next, motion);
  report.nonlinear_iterations = solver.iterations();
  if (!report.ok()) {
    report.culprit = find_spent_pull(*this, pinned, grabs, bonds, frame, next.positions);
    if (report.culprit.empty()) report.culprit = find_culprit(frame, next.positions, next.forces);
    return report;
  }
  state = {std::move(next.positions), std::vector<Vec3>(nodes(), Vec3::Zero()), std::move(next.rotations)};
  state.grabs = std::move(grabs);
  state.bonds = std::move(bonds);
  return report;
}

}  // namespace softreel
