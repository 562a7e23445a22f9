/// One implicit step, by one linear solve, eq. (2), for every integrator, or iterated (design 4.4).
///
/// With Rayleigh damping C = Ma + Kb (both per element), the integrator's bases x', v' and seconds t, r of TimeStep,
/// and forces f linearised at positions x* with their rotations, the velocities v at the end have
///   (M + t C + t r K) v = M v' + t f + t K (x* - x').
/// Solved is the change d = v - v' by S d = right side - S v', S = M + t Ma + sum t (r + b) K_e. The paper's implicit
/// Euler at the step's start has t = r = h and x* = x' = x: eq. (2). Unlike there, where displacements are solved for
/// and the force correction f0 stands beside K, the elastic force is evaluated by itself: it is the same force, but
/// exact for a capped dilatation and without the cancellation of K x against f0. Beside t r K stands t r G, the
/// stiffness that tension adds, where leaving it out could make the body flutter (core/elasticity/tension.h): it enters
/// matrix and right side alike, so at rest nothing changes. So does the secant where K's dilatation is at its limit, if
/// x* is extrapolated (step_pressure_slope).
#include <algorithm>
#include <cmath>

#include "core/dynamics/linear_system.h"
#include "core/dynamics/step_work.h"
#include "core/elasticity/tension.h"
#include "core/elasticity/thickness.h"

namespace softreel {
namespace {

/// Relative residuals below this are rounding.
constexpr double kLeastSensible = 1e-12;

/// Share of the tension harmless by find_tension_limits that is left out: half, as thickness is only estimated. From a
/// predictor half of a ninth, on the safe side: by linear theory Euler bears a third there and BDF2 a quarter
/// (linearization_positions).
double explicit_share(const SolverParams& params) {
  // Iterated steps that recovery makes one solve linearise at the predictor.
  const bool at_start = params.integrator == Integrator::Euler && linearization(params) == Linearize::Start;
  return at_start ? 0.5 : 0.5 / 9;
}

/// Which nodes elements connect: bodies that glue joins do not bend as one.
BlockPattern element_pattern(const Simulator::Parts& parts) {
  if (parts.joints.empty()) return parts.matrix.pattern;
  return stiffness_pattern(parts.model.mesh.tets, static_cast<Index>(parts.nodes()));
}

/// What the elements are linearised at, with their tension limits. A rotation that does not turn has no curvature, and
/// accelerations reach no positions.
StepSource find_source(Simulator::Parts& parts, const StepWork& work, std::span<const Vec3> end_velocities) {
  StepSource source{work.positions,          end_velocities, work.rotations,   work.step.seconds,
                    parts.damping_stiffness, work.offsets,   work.kept_change, {}};
  source.secant_at_limit = linearization(parts.params) != Linearize::Start;
  if (parts.params.rotation == RotationMethod::None || source.seconds.position == 0) return source;
  if (parts.tension_limits.empty())
    parts.tension_limits = find_tension_limits(
        parts.body, find_thickness(parts.model.mesh, element_pattern(parts), youngs_moduli(parts.model.materials)),
        parts.model.materials, explicit_share(parts.params));
  source.tension_limits = parts.tension_limits;
  if (!source.secant_at_limit) return source;  // those are the start's
  source.start_positions = parts.state.positions;
  source.start_rotations = parts.state.rotations;
  return source;
}

/// S, from elements, masses and pulls.
void assemble_step(Simulator::Parts& parts, StepWork& work) {
  const StepSeconds& seconds = work.step.seconds;
  std::vector<double> shares(parts.body.tets.size());
  for (std::size_t e = 0; e < shares.size(); ++e)
    shares[e] = seconds.velocity * (seconds.position + parts.damping_stiffness[e]);
  find_stiffness_terms(parts.body, work.positions, work.rotations, shares, Curvature::None, parts.terms, parts.threads);
  const StepSource source = find_source(parts, work, {});
  take_step_slopes(parts.body, source, parts.terms, parts.threads);
  parts.terms.curvatures = find_tension_curvatures(parts.body, source, parts.threads);
  parts.assembler().assemble(parts.terms, work.node_terms, parts.matrix, parts.threads);
  for (const ActivePull& pull : work.pulls)
    add_pull_stiffness(pull, work.positions, seconds.velocity * seconds.position, parts.matrix);
}

/// forces -= scale * (secant) stiffness of a pull * vectors.
void subtract_pull_product(const ActivePull& pull, std::span<const Vec3> positions, double scale,
                           std::span<const Vec3> vectors, std::span<Vec3> forces) {
  const double factor = scale * pull_factor(pull, positions);
  for (const Spring& spring : pull.springs) {
    Vec3 vector = Vec3::Zero();
    for (std::size_t k = 0; k < spring.count; ++k)
      vector += spring.weights[k] * vectors[static_cast<std::size_t>(spring.nodes[k])];
    for (std::size_t k = 0; k < spring.count; ++k)
      forces[static_cast<std::size_t>(spring.nodes[k])] -= factor * spring.stiffness * spring.weights[k] * vector;
  }
}

}  // namespace

void find_residual(Simulator::Parts& parts, const StepWork& work, std::span<const Vec3> end_velocities,
                   std::span<const Vec3> change, std::span<Vec3> residual) {
  const StepSeconds& seconds = work.step.seconds;
  const double t = seconds.velocity;
  find_step_terms(parts.body, find_source(parts, work, end_velocities), parts.step_terms, parts.threads);
  gather_step_forces(parts.body, parts.step_terms, residual, parts.threads);
  const Vec3 gravity = t * parts.model.gravity;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    residual[i] += parts.masses.mass[i] * gravity - t * parts.masses.damping[i] * work.velocities[i];
    if (!change.empty()) residual[i] -= work.node_terms[i] * change[i];
  }
  for (const ActivePull& pull : work.pulls) {
    add_pull_forces(pull, work.positions, residual, t);
    subtract_pull_product(pull, work.positions, t * seconds.position, end_velocities, residual);
    if (!work.offsets.empty()) subtract_pull_product(pull, work.positions, t, work.offsets, residual);
  }
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (work.pinned.held[i] != 0) residual[i].setZero();
}

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

SolveReport solve_step_in_double(Simulator::Parts& parts, StepWork& work) {
  {
    const ScopedStage stage(parts.times, "simulate/assemble");
    work.right_side.resize(parts.nodes());
    find_residual(parts, work, work.velocities, {}, work.right_side);
    assemble_step(parts, work);
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
  const double asked = parts.params.tolerance, beyond = std::max(1.0, rigidity_beyond_float(parts, work)),
               tolerance = std::max(asked / beyond, std::min(asked, kLeastSensible));
  SolveReport report =
      parts.multigrid.solve(parts.matrix, work.right_side, work.change, tolerance, 0.0, parts.params.max_iterations);
  // A residual of 0 without success is one over a right side whose norm is not finite.
  if (!report.ok() && report.residual > 0 && report.residual <= asked) report.status = SolveStatus::Converged;
  correct_translations(parts, work);
  return report;
}

}  // namespace softreel
