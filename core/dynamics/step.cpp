/// A step from the present state: its beginning by the integrator, one solve or an iteration, and the state after it.
/// The linear system is that of step_system.cpp.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/error.h"
#include "core/base/fingerprint.h"
#include "core/constraints/targets.h"
#include "core/dynamics/step_work.h"

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
void begin_step(Simulator::Parts& parts, StepWork& work, double h, StepStage stage) {
  const SimulationState& state = parts.state;
  work.step = begin_time_step(parts.params, state, h, stage);
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

/// The state after the step; not ok if it is not finite.
SimulationState take_finite_end(const Simulator::Parts& parts, StepWork& work, StepReport& report) {
  SimulationState next = advanced(parts, work);
  if (!all_finite(next.positions) || !all_finite(next.velocities)) report.solve.status = SolveStatus::Breakdown;
  return next;
}

/// `next` becomes the state, unless its error is too great: that of the integrator, in m.
void accept_or_reject(Simulator::Parts& parts, double error, double error_limit, SimulationState& next,
                      StepReport& report) {
  if (std::isfinite(error_limit)) {
    report.error = error / parts.body_size;
    report.rejected = report.error > error_limit;
    next.previous_error = report.error;
  }
  if (report.rejected) return;
  parts.state = std::move(next);
  parts.known_rest.known = false;
}

StepReport take_whole_step(Simulator::Parts& parts, double frame, double seconds, double error_limit, StepWork& work) {
  begin_step(parts, work, seconds, StepStage::Whole);
  StepReport report = solve_step(parts, frame, work);
  if (!report.ok()) return report;
  SimulationState next = take_finite_end(parts, work, report);
  const bool controlled = std::isfinite(error_limit);
  if (report.ok())
    accept_or_reject(
        parts, controlled ? estimate_error(parts.params, parts.state, seconds, work.pinned.held, next.positions) : 0,
        error_limit, next, report);
  return report;
}

/// What the first stage works on: held nodes are on their way, and all that pulls is where it will be at the step's
/// end, which costs an error of third order once.
StepWork first_stage_of(const SimulationState& state, const StepWork& work) {
  StepWork stage = work;
  for (std::size_t i = 0; i < stage.pinned.held.size(); ++i)
    if (stage.pinned.held[i] != 0)
      stage.pinned.targets[i] = state.positions[i] + kFirstStage * (work.pinned.targets[i] - state.positions[i]);
  return stage;
}

void add_stage(const StepReport& stage, StepReport& report) {
  report.solve.iterations += stage.solve.iterations;
  report.nonlinear_iterations += stage.nonlinear_iterations;
  report.recovery.elements = std::max(report.recovery.elements, stage.recovery.elements);
}

/// See kFirstStage. On failure the state may be that after the first stage.
StepReport take_two_stages(Simulator::Parts& parts, double frame, double seconds, double error_limit, StepWork& work) {
  SimulationState start = parts.state;
  StepWork stage = first_stage_of(start, work);
  begin_step(parts, stage, kFirstStage * seconds, StepStage::First);
  const StepReport first = solve_step(parts, frame, stage);
  StepReport report = first;
  if (report.ok()) parts.state = take_finite_end(parts, stage, report);
  if (!report.ok()) {
    work.right_side = std::move(stage.right_side);
    return report;
  }
  work.rotations = parts.state.rotations;
  work.troubles = parts.state.troubles;
  begin_step(parts, work, (1 - kFirstStage) * seconds, StepStage::Second);
  report = solve_step(parts, frame, work);
  add_stage(first, report);
  if (!report.ok()) return report;
  SimulationState next = take_finite_end(parts, work, report);
  if (!report.ok()) return report;
  next.previous_seconds = seconds;
  next.previous_positions = std::move(start.positions);
  next.previous_velocities = std::move(start.velocities);
  next.previous_accelerations = std::move(start.accelerations);
  accept_or_reject(parts,
                   estimate_staged_error(seconds, work.pinned.held, parts.state.accelerations, next.accelerations),
                   error_limit, next, report);
  return report;
}

}  // namespace

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
  const bool staged = takes_two_stages(params, state);
  if (staged && !before) before = state;
  report = (staged ? take_two_stages : take_whole_step)(*this, frame, seconds, error_limit, work);
  if (ends_frame) coarse_lag.usable = false;
  if (report.ok() && !report.rejected)
    state.grabs = grabs_at(frame);
  else if (before)
    state = std::move(*before);
  if (!report.ok()) report.culprit = find_culprit(frame, state.positions, work.right_side);
  return report;
}

}  // namespace softreel
