/// One implicit step iterated to force balance: Newton with line search on inertia + damping + elasticity - loads, the
/// method of statics on a richer potential (design 4.4).
#include "core/dynamics/static_solver.h"
#include "core/dynamics/step_work.h"

namespace softreel {
namespace {

/// D of StepPotential; without values if no element has damping of this kind. Its rotations are frozen, or the damping
/// had no potential: Euler's at the step's start, those of second order at the predictor of its end, as with rotations
/// of the start the damping forces, and with them the step, would be of first order.
BlockMatrixd assemble_damping(Simulator::Parts& parts, const StepWork& work) {
  BlockMatrixd damping{parts.matrix.pattern, {}};
  std::vector<double> shares(parts.damping_stiffness);
  bool damped = false;
  for (double& share : shares) {
    damped = damped || share > 0;
    share /= work.step.seconds.position;
  }
  if (!damped) return damping;
  const bool euler = parts.params.integrator == Integrator::Euler;
  const std::vector<Vec3>& positions = euler ? parts.state.positions : work.positions;
  std::vector<Quaternion> rotations = parts.state.rotations;
  find_rotations(parts.body, parts.params.rotation, positions, rotations, parts.threads);
  find_stiffness_terms(parts.body, positions, rotations, shares, Curvature::None, parts.terms, {}, parts.threads);
  parts.assembler().assemble(parts.terms, std::vector<double>(parts.nodes(), 0.0), damping, parts.threads);
  return damping;
}

StepPotential find_potential(Simulator::Parts& parts, const StepWork& work) {
  const TimeStep& step = work.step;
  const double t = step.seconds.velocity, r = step.seconds.position;
  StepPotential potential{{}, {}, step.base_positions, assemble_damping(parts, work)};
  for (std::size_t i = 0; i < parts.nodes(); ++i) {
    const double mass = parts.masses.mass[i], weight = (mass / t + parts.masses.damping[i]) / r;
    potential.weights.push_back(weight);
    potential.centers.push_back(step.base_positions[i] + mass / (t * weight) * step.base_velocities[i]);
  }
  return potential;
}

/// True if a held node is not at its target yet.
bool pins_move(const PinnedNodes& pinned, std::span<const Vec3> positions) {
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (pinned.held[i] != 0 && positions[i] != pinned.targets[i]) return true;
  return false;
}

}  // namespace

StepReport iterate_step(Simulator::Parts& parts, StepWork& work) {
  const StepPotential potential = find_potential(parts, work);
  // Inertia leaves no rigid motion of a piece free, as statics has them.
  const std::vector<std::uint8_t> held_pieces(static_cast<std::size_t>(parts.pieces.count), 1);
  StaticSolver solver(parts, work.pinned.held, held_pieces, work.pulls, &potential);
  // The full step that moves pins wants a body that has not left them: it begins where the body is.
  const bool from_start = pins_move(work.pinned, parts.state.positions);
  StaticState next{from_start ? parts.state.positions : work.positions, work.rotations, {}};
  StepReport report;
  report.solve =
      solver.solve(next, work.pinned.targets, parts.params.force_tolerance, parts.params.max_newton_iterations);
  report.nonlinear_iterations = solver.iterations();
  work.rotations = std::move(next.rotations);
  work.right_side = std::move(next.forces);
  work.change.resize(parts.nodes());
  for (std::size_t i = 0; i < parts.nodes(); ++i)
    work.change[i] =
        (next.positions[i] - work.step.base_positions[i]) / work.step.seconds.position - work.velocities[i];
  return report;
}

}  // namespace softreel
