#include "tool/bodies/simulate_key.h"

#include <algorithm>

#include "core/constraints/targets.h"
#include "core/dynamics/frame_steps.h"

namespace softreel {
namespace {

/// Raised whenever the same inputs would give other frames.
constexpr const char* kSimulationVersion = "simulation 34";

void add(KeyHasher& key, const Transform& t) {
  key.add(t.translate).add(t.rotate).add(t.scale);
  // A pivot that nothing turns or scales about has no effect.
  if (!t.rotate.isZero(0) || t.scale != Vec3::Ones()) key.add(t.pivot);
}

/// Where an active pin or pull takes its points. One that grabs starts anew in another range.
template <typename Constraint>
void add_motion(KeyHasher& key, const Constraint& constraint, double frame) {
  if (constraint.follow != nullptr)
    key.add(constraint.follow->pose(frame));
  else
    add(key, constraint.track.at(frame));
  if (constraint.grab) key.add(active_range(constraint.active, frame));
}

/// An inactive constraint has no value: its keys may change freely.
void add_constraints(KeyHasher& key, const BodyConstraints& constraints, double frame) {
  for (const Pin& pin : constraints.pins) {
    const bool active = is_active(pin.active, frame);
    key.add(active);
    if (active) add_motion(key, pin, frame);
  }
  for (const Pull& pull : constraints.pulls) {
    const double stiffness = is_active(pull.active, frame) ? pull.stiffness.at(frame) : 0.0;
    key.add(stiffness);
    if (stiffness > 0) add_motion(key, pull, frame);
  }
  for (const Glue& glue : constraints.glues) {
    const bool sticks = is_sticking(glue, frame);
    key.add(sticks);
    if (sticks) key.add(active_range(glue.active, frame));  // it binds anew in each
    if (sticks && !glue.stiffness.keys.empty()) key.add(glue.stiffness.at(frame));
    if (sticks && glue.close_frames > 0) key.add(frame);
  }
}

/// What integrators with a memory begin anew at: by their values, pulls of no strength are as those that are off.
void add_jumps(KeyHasher& key, const Shot& shot, const BodyConstraints& constraints, double frame) {
  if (shot.solver.integrator == Integrator::Euler) return;
  for (const Pull& pull : constraints.pulls)
    if (!pull.active.empty()) key.add(count_jumps(pull, frame));
}

/// What is followed and whether it is grabbed, at all frames; nothing where neither is, as in shots without them.
template <typename Constraint>
void add_guide(KeyHasher& key, const Constraint& constraint) {
  if (constraint.grab) key.add("grab");
  if (constraint.follow == nullptr) return;
  key.add("follow").add(constraint.follow->content());
  for (const FollowTie& tie : constraint.ties) key.add(tie.vertices).add(tie.weights);
}

/// What the steps of a dynamic shot depend on; "auto" is the key of what it stands for.
void add_steps(KeyHasher& key, const SolverParams& solver) {
  key.add(solver.substeps).add(solver.tolerance).add(solver.integrator).add(linearization(solver));
  if (solver.integrator == Integrator::Newmark) key.add(solver.newmark.beta).add(solver.newmark.gamma);
  key.add(solver.step_error);
  if (solver.step_error > 0) key.add(frame_grid(solver).ticks_per_frame());
  key.add(solver.rest_tolerance).add(solver.matrix_lag).add(solver.keep_hierarchy);
}

}  // namespace

bool has_grabs(const BodyConstraints& constraints) {
  const auto grabs = [](const auto& constraint) { return constraint.grab; };
  return std::any_of(constraints.pins.begin(), constraints.pins.end(), grabs) ||
         std::any_of(constraints.pulls.begin(), constraints.pulls.end(), grabs);
}

StageKey simulation_base_key(const Shot& shot, const SolverParams& solver, const BodyConstraints& constraints,
                             const StageKey& filled, const StageKey& materials) {
  KeyHasher key(kSimulationVersion);
  key.add(filled).add(materials).add(shot.gravity).add(shot.settings.mode);
  key.add(solver.rotation).add(solver.dilatation).add(solver.max_iterations);
  if (shot.settings.mode == SimulationMode::Dynamic) {
    key.add(solver.recovery).add(shot.settings.fps).add(shot.settings.start);
    add_steps(key, solver);
  } else {
    key.add(shot.settings.independent);
  }
  const bool balances = shot.settings.mode == SimulationMode::Static ||
                        shot.settings.start == StartState::Equilibrium || linearization(solver) == Linearize::Iterated;
  if (balances) key.add(solver.max_newton_iterations);
  if (balances || solver.rest_tolerance > 0) key.add(solver.force_tolerance);
  const MultigridParams& multigrid = solver.multigrid;
  key.add(multigrid.galerkin).add(multigrid.method).add(multigrid.coarse_cycle).add(multigrid.smoother);
  key.add(multigrid.sweeps).add(multigrid.chebyshev_degree);
  for (const Pin& pin : constraints.pins) {
    key.add(pin.points);
    add_guide(key, pin);
  }
  for (const Pull& pull : constraints.pulls) {
    key.add(pull.points).add(pull.weights).add(pull.max_force);
    add_guide(key, pull);
  }
  return key.key();
}

StageKey frame_key(const Shot& shot, const BodyConstraints& constraints, const StageKey& previous, int frame,
                   bool is_start) {
  KeyHasher key("frame");
  key.add(previous);
  // What grabs or sticks remembers since which frame.
  if (is_start && (has_grabs(constraints) || !constraints.glues.empty())) key.add(frame);
  if (is_start && shot.settings.mode == SimulationMode::Dynamic && shot.settings.start == StartState::Rest) {
    if (has_grabs(constraints)) add_constraints(key, constraints, frame);
    return key.key();
  }
  if (is_start || shot.settings.mode == SimulationMode::Static) {
    add_constraints(key, constraints, frame);
    return key.key();
  }
  const int ticks = frame_grid(shot.solver).ticks_per_frame();
  for (int tick = 1; tick <= ticks; ++tick) {
    const double at = frame - 1 + static_cast<double>(tick) / ticks;
    add_constraints(key, constraints, at);
    add_jumps(key, shot, constraints, at);
  }
  return key.key();
}

StageKey constraints_key(const BodyConstraints& constraints, double frame) {
  KeyHasher key("constraints");
  add_constraints(key, constraints, frame);
  return key.key();
}

int first_simulated_frame(const Shot& shot) {
  return shot.settings.first_frame - shot.settings.preroll;
}

std::vector<StageKey> simulation_keys(const Shot& shot, const SolverParams& solver, const BodyConstraints& constraints,
                                      const StageKey& filled, const StageKey& materials) {
  return chain_keys(shot, constraints, simulation_base_key(shot, solver, constraints, filled, materials));
}

std::vector<StageKey> chain_keys(const Shot& shot, const BodyConstraints& constraints, const StageKey& base) {
  const bool from_rest = shot.settings.mode == SimulationMode::Static && shot.settings.independent;
  const int start = first_simulated_frame(shot);
  std::vector<StageKey> keys;
  for (int frame = start; frame <= shot.settings.last_frame; ++frame)
    keys.push_back(
        frame_key(shot, constraints, frame == start || from_rest ? base : keys.back(), frame, frame == start));
  return keys;
}

}  // namespace softreel
