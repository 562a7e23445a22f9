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
#include <optional>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/fingerprint.h"
#include "core/constraints/targets.h"
#include "core/dynamics/linear_system.h"
#include "core/dynamics/step_work.h"
#include "core/elasticity/tension.h"
#include "core/elasticity/thickness.h"

namespace softreel {

bool all_finite(std::span<const Vec3> vectors) {
  for (const Vec3& v : vectors)
    if (!v.allFinite()) return false;
  return true;
}

namespace {

/// A limited pull may be that much stronger at the end of a step than it may be.
constexpr double kForceExcess = 0.01;
/// What is beyond the strength of a pull softens it by their ratio in each solve, and further in the next step.
constexpr int kMostSolves = 8;

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

/// The system in double: for tolerances that float does not reach, and where it failed. Rigid motions of a very stiff
/// part, and what is soft beside it, have rows that are small beside those of its stiffness. A residual relative to all
/// of the right side has to be smaller by as much, or they are hardly solved, which acts like forces on them: blocks
/// 1e8 times as stiff as those between them flew apart. A body that is all of one stiffness is solved tighter with
/// them. Where that does not come to an end, the tolerance that was asked for is enough.
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

SolveReport solve_once(Simulator::Parts& parts, StepWork& work, StepReport& step) {
  const double t = work.step.seconds.velocity;
  work.node_terms.resize(parts.nodes());
  for (std::size_t i = 0; i < work.node_terms.size(); ++i)
    work.node_terms[i] = parts.masses.mass[i] + t * parts.masses.damping[i];
  if (suits_float(parts, work)) {
    const SolveReport report = solve_step_in_float(parts, work, step);
    if (report.ok()) return report;
  }
  parts.coarse_lag.usable = false;
  return solve_step_in_double(parts, work);
}

/// Accelerations that forces and damping give a state without any; zero of held nodes.
std::vector<Vec3> find_accelerations(Simulator::Parts& parts, const PinnedNodes& pinned,
                                     const std::vector<ActivePull>& pulls) {
  const SimulationState& state = parts.state;
  StepWork work{{0, {1, 0}, state.positions, state.velocities},
                pinned,
                pulls,
                state.positions,
                state.rotations,
                {},
                state.velocities,
                {},
                {},
                {}};
  find_rotations(parts.body, parts.params.rotation, work.positions, work.rotations, parts.threads);
  std::vector<Vec3> accelerations(parts.nodes());
  find_residual(parts, work, work.velocities, {}, accelerations);
  for (std::size_t i = 0; i < accelerations.size(); ++i) accelerations[i] /= parts.masses.mass[i];
  return accelerations;
}

/// Bases of the integrator, such that held nodes get to their targets, and the place of linearisation.
void begin_step(Simulator::Parts& parts, StepWork& work, double h) {
  const SimulationState& state = parts.state;
  work.step = begin_time_step(parts.params, state, h);
  work.velocities = work.step.base_velocities;
  const bool at_start = linearization(parts.params) == Linearize::Start;
  work.positions = at_start ? state.positions : linearization_positions(parts.params, state, h);
  const bool euler_at_start = at_start && parts.params.integrator == Integrator::Euler;
  for (std::size_t i = 0; i < parts.nodes(); ++i) {
    if (work.pinned.held[i] == 0) continue;
    const Vec3& target = work.pinned.targets[i];
    work.velocities[i] = find_held_motion(parts.params, state, i, target, h).velocity;
    if (euler_at_start) continue;  // its base is where the node is
    work.step.base_positions[i] = target - work.step.seconds.position * work.velocities[i];
    if (!at_start) work.positions[i] = target;
  }
  if (euler_at_start) return;
  work.offsets.resize(parts.nodes());
  for (std::size_t i = 0; i < work.offsets.size(); ++i)
    work.offsets[i] = work.step.base_positions[i] - work.positions[i];
}

/// Those of held nodes are known.
std::vector<Vec3> final_velocities(const StepWork& work) {
  std::vector<Vec3> velocities = work.velocities;
  for (std::size_t i = 0; i < velocities.size(); ++i)
    if (work.pinned.held[i] == 0) velocities[i] += work.change[i];
  return velocities;
}

/// Where such velocities lead; held nodes reach their targets exactly.
std::vector<Vec3> final_positions(const StepWork& work, std::span<const Vec3> velocities) {
  std::vector<Vec3> positions = work.step.base_positions;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (work.pinned.held[i] != 0)
      positions[i] = work.pinned.targets[i];
    else
      positions[i] += work.step.seconds.position * velocities[i];
  }
  return positions;
}

/// The state after the step.
SimulationState advanced(const Simulator::Parts& parts, StepWork& work) {
  SimulationState next{{}, final_velocities(work), std::move(work.rotations)};
  next.positions = final_positions(work, next.velocities);
  next.troubles = std::move(work.troubles);
  next.grabs = parts.state.grabs;
  next.bonds = std::move(work.bonds);
  next.constraints = work.constraints;
  remember(parts.params, work.step, parts.state, work.pinned.held, work.pinned.targets, next);
  // Of an iterated step; Newmark itself does not need them.
  const bool iterated = linearization(parts.params) == Linearize::Iterated;
  if (parts.params.integrator == Integrator::Newmark && iterated && parts.damps_strain())
    next.previous_positions = parts.state.positions;
  return next;
}

/// Springs softened by the least of the factors so far and those at `ends`. True if one fell by more than kForceExcess.
bool lower_factors(const std::vector<ActivePull>& pulls, std::span<const Vec3> ends, std::vector<double>& factors) {
  bool fell = false;
  for (std::size_t p = 0; p < pulls.size(); ++p) {
    const double factor = pull_factor(pulls[p], ends);
    if (factors[p] <= factor * (1 + kForceExcess)) continue;
    factors[p] = factor;
    fell = true;
  }
  return fell;
}

/// One solve, and another where a limited pull would be stronger than it may at the end. Its springs are softened by
/// the least of its factors at the start, where the body is going, and at the ends found so far: what a body moves
/// away from, and glue under a load beyond its strength, is pulled by max_force from the first step on.
SolveReport solve_within_limits(Simulator::Parts& parts, StepWork& work, StepReport& step) {
  const auto is_limited = [](const ActivePull& pull) { return pull.max_force > 0; };
  if (std::none_of(work.pulls.begin(), work.pulls.end(), is_limited)) return solve_once(parts, work, step);
  const std::vector<ActivePull> limited = work.pulls;
  std::vector<double> factors;
  for (const ActivePull& pull : limited) factors.push_back(pull_factor(pull, work.positions));
  lower_factors(limited, final_positions(work, work.velocities), factors);
  SolveReport report;
  int iterations = 0;
  for (int solves = 0; solves < kMostSolves; ++solves) {
    for (std::size_t p = 0; p < limited.size(); ++p) work.pulls[p] = softened(limited[p], factors[p]);
    report = solve_once(parts, work, step);
    iterations += report.iterations;
    if (!report.ok() || !lower_factors(limited, final_positions(work, final_velocities(work)), factors)) break;
  }
  report.iterations = iterations;
  return report;
}

/// Rotations shared by recovery have no energy to iterate on: then even an iterated step is one solve.
StepReport solve_step(Simulator::Parts& parts, double frame, StepWork& work) {
  const RecoveryReport recovery = find_step_rotations(parts, frame, work);
  StepReport report;
  if (linearization(parts.params) == Linearize::Iterated && recovery.elements == 0) {
    parts.coarse_lag.usable = false;  // its tangents take the place of the float matrix
    report = iterate_step(parts, work);
  } else {
    report.solve = solve_within_limits(parts, work, report);
  }
  report.recovery = recovery;
  return report;
}

/// Makes the step's end the state, unless it is not finite or its error is too great.
void accept_or_reject(Simulator::Parts& parts, StepWork& work, double error_limit, StepReport& report) {
  SimulationState next = advanced(parts, work);
  if (!all_finite(next.positions) || !all_finite(next.velocities)) {
    report.solve.status = SolveStatus::Breakdown;
    return;
  }
  if (std::isfinite(error_limit)) {
    report.error =
        estimate_error(parts.params, parts.state, work.step.h, work.pinned.held, next.positions) / parts.body_size;
    report.rejected = report.error > error_limit;
    next.previous_error = report.error;
  }
  if (report.rejected) return;
  parts.state = std::move(next);
  parts.known_rest.known = false;
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

/// Of which nodes are held and how often pulls have jumped; never 0. These change where a step begins. Stiffness that
/// is keyed to nothing does so at the end of one, to which it is early already; bonds of glue come and go too often to
/// begin anew with each.
std::uint64_t fingerprint_of(const PinnedNodes& pinned, const std::vector<Pull>& pulls, double frame) {
  Fingerprint print;
  for (std::size_t i = 0; i < pinned.held.size(); ++i)
    if (pinned.held[i] != 0) print.add(static_cast<Index>(i));
  for (const Pull& pull : pulls) print.add(count_jumps(pull, frame));
  return print.value() | 1U;
}

/// Makes the state ready for a first step, and for one after a jump of the forces. What it was before, where it
/// changed.
std::optional<SimulationState> begin_anew(Simulator::Parts& parts, const StepWork& work) {
  SimulationState& state = parts.state;
  const bool first = lacks_accelerations(parts.params, state);
  const bool jumps = state.constraints != 0 && state.constraints != work.constraints;
  if (!first && !jumps) return std::nullopt;
  std::optional<SimulationState> before = state;
  std::vector<Vec3> accelerations;
  if (parts.params.integrator == Integrator::Newmark)
    accelerations = find_accelerations(parts, work.pinned, work.pulls);
  if (first)
    state.accelerations = std::move(accelerations);
  else
    forget_before_jump(parts.params, work.pinned.held, accelerations, state);
  return before;
}

StepReport Simulator::Parts::step(double frame, double seconds, double error_limit) {
  StepWork work{{}, pins.at(frame, state.grabs.pins), {}, {}, state.rotations, {}, {}, {}, {}, {}, state.troubles};
  StepReport report;
  if (!work.pinned.conflict.empty()) throw input_error(work.pinned.conflict);
  work.bonds = bonds_at(frame);
  join(work.bonds);
  work.pulls = pulls_at(frame, state.grabs, work.bonds);
  const bool ends_frame = frame == std::floor(frame);
  if (is_at_rest(*this, work.pinned, work.pulls)) {
    if (ends_frame) coarse_lag.usable = false;
    report.nonlinear_iterations = 0;
    report.at_rest = true;
    state.grabs = grabs_at(frame);
    state.bonds = std::move(work.bonds);
    return report;
  }
  work.constraints = params.integrator == Integrator::Euler ? 0 : fingerprint_of(work.pinned, model.pulls, frame);
  std::optional<SimulationState> before = begin_anew(*this, work);
  begin_step(*this, work, seconds);
  report = solve_step(*this, frame, work);
  if (ends_frame) coarse_lag.usable = false;
  if (report.ok()) accept_or_reject(*this, work, error_limit, report);
  if (report.ok() && !report.rejected)
    state.grabs = grabs_at(frame);
  else if (before)
    state = std::move(*before);
  if (!report.ok()) report.culprit = find_culprit(frame, state.positions, work.right_side);
  return report;
}

}  // namespace softreel
