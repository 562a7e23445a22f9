/// One implicit Euler step by one linear solve, eq. (2) with rotations at the step's start (design 4.4).
///
/// With Rayleigh damping C = Ma + Kb (both per element) and forces f at the step's start, implicit Euler linearised
/// there is (M + h C + h^2 K) v' = M v + h f, so the change d = v' - v solves S d = h f + M v - S v with S = M + h Ma +
/// sum (h^2 + h b) K_e. Unlike the paper's eq. (2), which solves for displacements and carries the force correction f0
/// beside K, the elastic force is evaluated by itself: it is the same force, but exact for a capped dilatation and
/// without the cancellation of K x against f0.
#include <cmath>

#include <fmt/format.h>

#include "core/dynamics/linear_system.h"
#include "core/dynamics/step_work.h"

namespace softreel {

bool all_finite(std::span<const Vec3> vectors) {
  for (const Vec3& v : vectors)
    if (!v.allFinite()) return false;
  return true;
}

namespace {

/// S, from elements, masses and pulls; on the way the stresses.
void assemble_step(Simulator::Parts& parts, StepWork& work) {
  const double h = work.h;
  std::vector<double> shares(parts.body.tets.size());
  for (std::size_t e = 0; e < shares.size(); ++e) shares[e] = h * h + h * parts.model.materials[e].damping_stiffness;
  parts.stresses.resize(shares.size());
  find_stiffness_terms(parts.body, parts.state.positions, work.rotations, shares, Curvature::None, parts.terms,
                       parts.stresses, parts.threads);
  parts.assembler().assemble(parts.terms, work.node_terms, parts.matrix, parts.threads);
  for (const ActivePull& pull : work.pulls) add_pull_stiffness(pull, parts.state.positions, h * h, parts.matrix);
}

/// h f + M v - S v on free nodes, where S v takes the held nodes at the velocity that carries them to their targets.
void find_right_side(Simulator::Parts& parts, StepWork& work) {
  const SimulationState& state = parts.state;
  const std::size_t n = parts.nodes();
  work.right_side.resize(n);
  parts.gather_all_forces(state.positions, work.pulls, work.right_side);
  std::vector<Vec3> product(n);
  multiply(parts.matrix, work.velocities, product, parts.threads);
  for (std::size_t i = 0; i < n; ++i) {
    if (work.pinned.held[i] != 0)
      work.right_side[i].setZero();
    else
      work.right_side[i] = work.h * work.right_side[i] + parts.masses.mass[i] * state.velocities[i] - product[i];
  }
}

/// The system in double: for tolerances that float does not reach, and where it failed.
SolveReport solve_step_in_double(Simulator::Parts& parts, StepWork& work) {
  {
    const ScopedStage stage(parts.times, "simulate/assemble");
    assemble_step(parts, work);
    find_right_side(parts, work);
  }
  work.change.assign(parts.nodes(), Vec3::Zero());
  if (!all_finite(work.right_side)) return {SolveStatus::Breakdown, 0, 0, false};
  {
    const ScopedStage stage(parts.times, "simulate/assemble");
    eliminate_held(parts.matrix, work.pinned.held, parts.threads);
  }
  correct_translations(parts, work);
  {
    const ScopedStage stage(parts.times, "simulate/update");
    parts.multigrid.update(parts.matrix, work.pinned.held);
  }
  const ScopedStage stage(parts.times, "simulate/solve");
  const SolveReport report = parts.multigrid.solve(parts.matrix, work.right_side, work.change, parts.params.tolerance,
                                                   0.0, parts.params.max_iterations);
  correct_translations(parts, work);
  return report;
}

SolveReport solve_step(Simulator::Parts& parts, StepWork& work) {
  const std::size_t n = parts.nodes();
  work.velocities = parts.state.velocities;
  work.node_terms.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    work.node_terms[i] = parts.masses.mass[i] + work.h * parts.masses.damping[i];
    if (work.pinned.held[i] != 0) work.velocities[i] = (work.pinned.targets[i] - parts.state.positions[i]) / work.h;
  }
  if (suits_float(parts, work.h)) {
    const SolveReport report = solve_step_in_float(parts, work);
    if (report.ok()) return report;
  }
  parts.coarse_lag.usable = false;
  return solve_step_in_double(parts, work);
}

/// The state after the step; held nodes reach their targets exactly.
SimulationState advanced(const Simulator::Parts& parts, StepWork& work) {
  SimulationState next{parts.state.positions, parts.state.velocities, std::move(work.rotations),
                       std::move(work.troubles)};
  for (std::size_t i = 0; i < parts.nodes(); ++i) {
    if (work.pinned.held[i] != 0) {
      next.velocities[i] = (work.pinned.targets[i] - next.positions[i]) / work.h;
      next.positions[i] = work.pinned.targets[i];
    } else {
      next.velocities[i] += work.change[i];
      next.positions[i] += work.h * next.velocities[i];
    }
  }
  return next;
}

}  // namespace

void correct_translations(const Simulator::Parts& parts, StepWork& work) {
  const std::vector<std::uint8_t> held = parts.held_pieces(work.pinned, work.pulls);
  std::vector<Vec3> missing(held.size(), Vec3::Zero());
  std::vector<double> mass(held.size(), 0);
  for (std::size_t i = 0; i < parts.nodes(); ++i) {
    const auto piece = static_cast<std::size_t>(parts.pieces.of_node[i]);
    missing[piece] += work.right_side[i] - work.node_terms[i] * work.change[i];
    mass[piece] += work.node_terms[i];
  }
  for (std::size_t i = 0; i < parts.nodes(); ++i) {
    const auto piece = static_cast<std::size_t>(parts.pieces.of_node[i]);
    if (held[piece] == 0 && mass[piece] > 0) work.change[i] += missing[piece] / mass[piece];
  }
}

StepReport Simulator::Parts::step(double frame, double seconds) {
  StepWork work{seconds, pins.at(frame), pulls_at(frame), state.rotations, {}, {}, {}, {}, state.troubles};
  StepReport report;
  if (!work.pinned.conflict.empty()) {
    report.solve.status = SolveStatus::Breakdown;
    report.culprit = work.pinned.conflict;
    return report;
  }
  report.recovery = find_step_rotations(*this, frame, work);
  report.solve = solve_step(*this, work);
  if (frame == std::floor(frame)) coarse_lag.usable = false;
  if (report.ok()) {
    SimulationState next = advanced(*this, work);
    if (all_finite(next.positions) && all_finite(next.velocities)) {
      state = std::move(next);
      return report;
    }
    report.solve.status = SolveStatus::Breakdown;
  }
  report.culprit = find_culprit(state.positions, work.right_side);
  return report;
}

}  // namespace softreel
