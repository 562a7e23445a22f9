/// One implicit step iterated to force balance: Newton with line search on inertia + damping + elasticity - loads, the
/// method of statics on a richer potential (design 4.4).
#include "core/dynamics/static_solver.h"
#include "core/dynamics/step_work.h"

namespace softreel {
namespace {

/// (U' - I) of an element, its norm: beyond, where its stretch turns over in a step, the tangent of its damping by
/// strains is too far from the truth for Newton (scrambled bodies took hundreds of iterations).
constexpr double kGreatestStrain = 0.5;

/// D of StepPotential, which takes over the elements that are too distorted; without values if none is. Its axes are
/// frozen at the step's start for Euler, for the others at the predictor of its end, or they were of first order.
BlockMatrixd take_distorted(Simulator::Parts& parts, const StepWork& work, StrainDamping& damping) {
  BlockMatrixd frozen{parts.matrix.pattern, {}};
  if (damping.empty() || parts.params.rotation == RotationMethod::None) return frozen;
  std::vector<double> shares(parts.damping_stiffness.size(), 0.0);
  bool any = false;
  for (std::size_t e = 0; e < shares.size(); ++e) {
    if (damping.ratios[e] == 0 || (damping.stretches[e] - Mat3::Identity()).norm() <= kGreatestStrain) continue;
    shares[e] = parts.damping_stiffness[e] / work.step.seconds.position;
    damping.ratios[e] = 0;
    any = true;
  }
  if (!any) return frozen;
  const bool euler = parts.params.integrator == Integrator::Euler;
  const std::vector<Vec3>& positions = euler ? parts.state.positions : work.positions;
  std::vector<Quaternion> rotations = parts.state.rotations;
  find_rotations(parts.body, parts.params.rotation, positions, rotations, parts.threads);
  find_stiffness_terms(parts.body, positions, rotations, shares, Curvature::None, parts.terms, parts.threads);
  parts.assembler().assemble(parts.terms, std::vector<double>(parts.nodes(), 0.0), frozen, parts.threads);
  return frozen;
}

/// Empty if no element has damping of this kind. The dilatation's slopes are those where the step linearises, so that
/// they are the same all through it.
StrainDamping find_strain_damping(const Simulator::Parts& parts, const StepWork& work) {
  StrainDamping damping;
  if (!parts.damps_strain()) return damping;
  const SimulationState& state = parts.state;
  const RotationMethod rotation = damping.rotation = parts.params.rotation;
  // Newmark's own strain rate would be that of its velocities, which keep for ever what of a rigid turn is a stretch in
  // them. By the strains alone it is of second order and stable, too: in the linear oscillator's recurrence the
  // difference's imaginary part has one sign on the unit circle, which no root then crosses.
  const BackwardDifference& rate = work.step.rate;
  damping.stretches = find_stretches(parts.body, rotation, state.positions, state.rotations, parts.threads);
  if (rate.back != 0) {
    const std::vector<Mat3> before =
        find_stretches(parts.body, rotation, state.previous_positions, state.rotations, parts.threads);
    for (std::size_t e = 0; e < before.size(); ++e)
      damping.stretches[e] += rate.back * (damping.stretches[e] - before[e]);
  }
  for (std::size_t e = 0; e < parts.body.tets.size(); ++e) {
    const Mat3 F = deformation_gradient(parts.body.shapes[e].gradients, nodes_of(parts.body.tets[e], work.positions));
    const double trace = corotated_strain(work.rotations[e].toRotationMatrix(), F).trace();
    damping.ratios.push_back(parts.damping_stiffness[e] / rate.seconds);
    damping.slopes.push_back(parts.body.laws[e].pressure_slope(trace));
  }
  return damping;
}

StepPotential find_potential(Simulator::Parts& parts, const StepWork& work) {
  const TimeStep& step = work.step;
  const double t = step.seconds.velocity, r = step.seconds.position;
  StepPotential potential{{}, {}, find_strain_damping(parts, work), step.base_positions, {}};
  potential.frozen_damping = take_distorted(parts, work, potential.damping);
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
