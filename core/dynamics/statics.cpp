#include <algorithm>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/dynamics/pin_motion.h"
#include "core/dynamics/static_solver.h"

namespace softreel {
namespace {

/// Newton iterations before a load step is halved, and the tolerance of those that are not the last.
constexpr int kStepIterations = 30;
constexpr double kStepTolerance = 1e-3;
constexpr double kSmallestLoadStep = 1.0 / 256;

/// A piece that nothing holds has no equilibrium under gravity.
void check_held(const Simulator::Parts& parts, const std::vector<std::uint8_t>& held, double frame) {
  if (parts.model.gravity.isZero(0)) return;
  const auto loose = std::find(held.begin(), held.end(), std::uint8_t{0});
  if (loose == held.end()) return;
  const auto piece = static_cast<Index>(loose - held.begin());
  const auto node = static_cast<std::size_t>(
      std::find(parts.pieces.of_node.begin(), parts.pieces.of_node.end(), piece) - parts.pieces.of_node.begin());
  const Vec3& at = parts.model.mesh.nodes[node];
  throw input_error(fmt::format(
      "{}: at frame {} no pin or pull holds {} (near ({:.6g}, {:.6g}, {:.6g})), so under gravity it falls for ever and "
      "has no equilibrium.\n  Accepted: a pin or pull on every piece, or no gravity. Add a pin, set gravity to 0, or "
      "use "
      "mode = \"dynamic\" with start = \"rest\".",
      parts.model.name, frame, held.size() == 1 ? "the body" : fmt::format("piece {} of the body", piece), at.x(),
      at.y(), at.z()));
}

/// Equilibrium at `targets`, in smaller moves of the held nodes where one is too much.
SolveReport solve_in_steps(const Simulator::Parts& parts, StaticSolver& solver, StaticState& state,
                           std::span<const std::uint8_t> held, std::span<const Vec3> targets) {
  const std::vector<Vec3> start = state.positions;
  std::vector<Vec3> partial(targets.begin(), targets.end());
  double done = 0, step = 1;
  SolveReport total;
  while (true) {
    const bool last = done + step >= 1;
    const double reached = last ? 1.0 : done + step;
    for (std::size_t i = 0; i < partial.size(); ++i)
      if (held[i] != 0) partial[i] = last ? targets[i] : Vec3(start[i] + reached * (targets[i] - start[i]));
    StaticState next{state.positions, state.rotations, {}};
    const int allowed = last && done > 0 ? parts.params.max_newton_iterations
                                         : std::min(kStepIterations, parts.params.max_newton_iterations);
    const int left = parts.params.max_newton_iterations - solver.iterations();
    const SolveReport report = solver.solve(next, partial, last ? parts.params.force_tolerance : kStepTolerance,
                                            std::max(0, std::min(allowed, left)));
    total.iterations += report.iterations;
    total.status = report.status;
    total.residual = report.residual;
    if (report.ok()) {
      state = std::move(next);
      if (last) return total;
      done = reached;
      step *= 1.5;
    } else {
      step *= 0.5;
      if (step < kSmallestLoadStep || left <= 0) {
        state.forces = std::move(next.forces);
        return total;
      }
    }
  }
}

}  // namespace

StepReport Simulator::Parts::find_equilibrium(double frame) {
  const PinnedNodes pinned = pins.at(frame);
  const std::vector<ActivePull> pulls = pulls_at(frame);
  StepReport report;
  if (!pinned.conflict.empty()) {
    report.solve.status = SolveStatus::Breakdown;
    report.culprit = pinned.conflict;
    return report;
  }
  const std::vector<std::uint8_t> held = held_pieces(pinned, pulls);
  check_held(*this, held, frame);
  StaticState next{state.positions, state.rotations, {}};
  follow_rigidly(pieces, pinned.held, pinned.targets, next.positions, next.rotations, body.tets);
  StaticSolver solver(*this, pinned.held, held, pulls);
  report.solve = solve_in_steps(*this, solver, next, pinned.held, pinned.targets);
  report.nonlinear_iterations = solver.iterations();
  if (!report.ok()) {
    report.culprit = find_culprit(next.positions, next.forces);
    return report;
  }
  state.positions = std::move(next.positions);
  state.rotations = std::move(next.rotations);
  std::fill(state.velocities.begin(), state.velocities.end(), Vec3::Zero());
  return report;
}

}  // namespace softreel
