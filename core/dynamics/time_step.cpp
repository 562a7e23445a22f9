#include "core/dynamics/time_step.h"

#include <algorithm>

namespace softreel {
namespace {

/// True if the integrator takes the step with what it remembers of the last one.
bool has_memory(const SolverParams& params, const SimulationState& state) {
  switch (params.integrator) {
    case Integrator::Bdf2:
      return !state.previous_positions.empty();
    case Integrator::Newmark:
      return state.previous_seconds > 0;
    case Integrator::Euler:
      break;
  }
  return false;
}

/// Mean velocity of the node over the last step.
Vec3 last_mean_velocity(const SolverParams& params, const SimulationState& state, std::size_t node) {
  if (params.integrator == Integrator::Bdf2)
    return (state.positions[node] - state.previous_positions[node]) / state.previous_seconds;
  return state.velocities[node] - 0.5 * state.previous_seconds * state.accelerations[node];
}

/// Of the distance between predictor and end, what is the error of the end, by Taylor's series with steps of one
/// length. Euler: h^2 a / 2 of h^2 a. BDF2: 2 / 9 of 2 / 9 + 5 / 12 times h^3 da/dt. Newmark: beta - 1 / 6 of beta
/// times that.
double error_share(const SolverParams& params) {
  if (params.integrator == Integrator::Newmark) return (params.newmark.beta - 1.0 / 6) / params.newmark.beta;
  return params.integrator == Integrator::Bdf2 ? 8.0 / 23 : 0.5;
}

/// Euler: v = v0 + h a, x = x0 + h v.
TimeStep begin_euler(const SimulationState& state, double h) {
  return {h, {h, h}, state.positions, state.velocities, {h, 0}};
}

/// Backward differentiation of second order where `state` knows the step before it, for steps of any lengths: with the
/// ratio of steps r = h / h0, the slope at the end of the parabola through y0 (a step of h0 earlier: yp) and y is
/// (y - y0 - r^2 / (1 + 2 r) (y0 - yp)) (1 + 2 r) / ((1 + r) h).
BackwardDifference backward_difference(const SimulationState& state, double h) {
  if (state.previous_positions.empty()) return {h, 0};
  const double r = h / state.previous_seconds;
  return {h * (1 + r) / (1 + 2 * r), r * r / (1 + 2 * r)};
}

/// The second stage, h seconds after the first: see kFirstStage.
BackwardDifference second_stage_difference(double h) {
  return {h * kFirstStage / (1 - kFirstStage), 1 / kFirstStage - 2};
}

/// Such a difference for y = x and y = v.
TimeStep begin_by_difference(const SimulationState& state, double h, const BackwardDifference& difference) {
  const auto [seconds, back] = difference;
  TimeStep step = begin_euler(state, h);
  step.seconds = {seconds, seconds};
  step.rate = difference;
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    step.base_positions[i] += back * (state.positions[i] - state.previous_positions[i]);
    step.base_velocities[i] += back * (state.velocities[i] - state.previous_velocities[i]);
  }
  return step;
}

/// linearization_positions of BDF2.
std::vector<Vec3> extrapolated_by_bdf2(const SimulationState& state, double h) {
  std::vector<Vec3> positions = state.positions;
  const double share = 0.5 * h / state.previous_seconds;
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] += 0.5 * h * state.velocities[i] + share * (state.positions[i] - state.previous_positions[i]);
  return positions;
}

/// v = v0 + h ((1 - gamma) a0 + gamma a), x = x0 + h v0 + h^2 ((1/2 - beta) a0 + beta a), the latter with a by v.
TimeStep begin_newmark(const NewmarkParams& newmark, const SimulationState& state, double h) {
  const double share = newmark.beta / newmark.gamma;
  TimeStep step = begin_euler(state, h);
  step.seconds = {newmark.gamma * h, share * h};
  step.rate = backward_difference(state, h);
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    step.base_positions[i] += (1 - share) * h * state.velocities[i] + (0.5 - share) * h * h * state.accelerations[i];
    step.base_velocities[i] += (1 - newmark.gamma) * h * state.accelerations[i];
  }
  return step;
}

/// begin_time_step but for the lag.
TimeStep begin_bases(const SolverParams& params, const SimulationState& state, double h, StepStage stage) {
  switch (params.integrator) {
    case Integrator::Bdf2:
      if (stage == StepStage::First) break;
      return begin_by_difference(
          state, h, stage == StepStage::Second ? second_stage_difference(h) : backward_difference(state, h));
    case Integrator::Newmark:
      return begin_newmark(params.newmark, state, h);
    case Integrator::Euler:
      break;
  }
  return begin_euler(state, h);
}

}  // namespace

bool takes_two_stages(const SolverParams& params, const SimulationState& state) {
  return params.integrator == Integrator::Bdf2 && !has_memory(params, state);
}

bool lacks_accelerations(const SolverParams& params, const SimulationState& state) {
  return params.integrator == Integrator::Newmark && state.accelerations.empty();
}

void forget_before_jump(const SolverParams& params, std::span<const std::uint8_t> held,
                        std::span<const Vec3> accelerations, SimulationState& state) {
  if (params.integrator == Integrator::Bdf2) {
    state.previous_positions.clear();
    state.previous_velocities.clear();
  }
  if (params.integrator != Integrator::Newmark) return;
  for (std::size_t i = 0; i < accelerations.size(); ++i)
    if (held[i] == 0) state.accelerations[i] = accelerations[i];
  state.previous_accelerations.clear();
}

double find_turn_lag(const SolverParams& params, const SimulationState& state, double h, StepStage stage) {
  if (linearization(params) != Linearize::Predictor || params.integrator == Integrator::Euler) return 0;
  if (stage == StepStage::First) return 1.0 / 3;
  if (!has_memory(params, state)) return 0;
  const double last = state.previous_seconds / h;
  if (params.integrator == Integrator::Bdf2 && stage == StepStage::Whole) return 1.0 / 4 + last / 6 + last * last / 12;
  return 1.0 / 3 + last / 2 + last * last / 6;  // by the line through the last two places
}

TimeStep begin_time_step(const SolverParams& params, const SimulationState& state, double h, StepStage stage) {
  TimeStep step = begin_bases(params, state, h, stage);
  step.turn_lag = find_turn_lag(params, state, h, stage);
  return step;
}

HeldNode find_held_motion(const SolverParams& params, const SimulationState& state, std::size_t node,
                          const Vec3& target, double h) {
  const Vec3 mean = (target - state.positions[node]) / h;
  if (!has_memory(params, state)) return {mean, Vec3::Zero()};
  const Vec3 slope = 2 / (h + state.previous_seconds) * (mean - last_mean_velocity(params, state, node));
  return {mean + 0.5 * h * slope, slope};
}

std::vector<Vec3> predict_positions(const SolverParams& params, const SimulationState& state, double h) {
  std::vector<Vec3> predicted = state.positions;
  const bool remembers = has_memory(params, state);
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    Vec3 change = h * state.velocities[i];
    if (params.integrator == Integrator::Newmark)
      change += 0.5 * h * h * state.accelerations[i];
    else if (remembers)
      change += 0.5 * h * h / state.previous_seconds * (state.velocities[i] - state.previous_velocities[i]);
    predicted[i] += change;
  }
  return predicted;
}

std::vector<Vec3> linearization_positions(const SolverParams& params, const SimulationState& state, double h) {
  if (!has_memory(params, state)) return predict_positions(params, state, h);
  if (params.integrator == Integrator::Bdf2) return extrapolated_by_bdf2(state, h);
  if (state.previous_accelerations.empty()) return predict_positions(params, state, h);
  const double beta = params.newmark.beta, gamma = params.newmark.gamma, last = state.previous_seconds;
  std::vector<Vec3> positions = state.positions;
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] += h * (state.velocities[i] + last * ((beta - gamma) * state.accelerations[i] +
                                                       (gamma - 0.5 - beta) * state.previous_accelerations[i]));
  return positions;
}

Linearize linearization(const SolverParams& params) {
  if (params.linearize != Linearize::Auto) return params.linearize;
  switch (params.integrator) {
    case Integrator::Euler:
      return Linearize::Start;
    case Integrator::Bdf2:
      return Linearize::Predictor;
    case Integrator::Newmark:
      break;
  }
  return Linearize::Iterated;
}

double estimate_error(const SolverParams& params, const SimulationState& state, double h,
                      std::span<const std::uint8_t> held, std::span<const Vec3> positions) {
  const std::vector<Vec3> predicted = predict_positions(params, state, h);
  double greatest = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (held[i] == 0) greatest = std::max(greatest, (positions[i] - predicted[i]).norm());
  return error_share(params) * greatest;
}

/// With the method's amplification (1 + (1 - 2 g) z) / (1 - g z)^2, the error of a step is 3 g^2 - 2 g^3 - 1 / 6 of h^3
/// da/dt, and the stages' ends are (1 - g) h apart.
double estimate_staged_error(double h, std::span<const std::uint8_t> held, std::span<const Vec3> first_accelerations,
                             std::span<const Vec3> second_accelerations) {
  constexpr double g = kFirstStage, kShare = (3 * g * g - 2 * g * g * g - 1.0 / 6) / (1 - g);
  double greatest = 0;
  for (std::size_t i = 0; i < held.size(); ++i)
    if (held[i] == 0) greatest = std::max(greatest, (second_accelerations[i] - first_accelerations[i]).norm());
  return kShare * h * h * greatest;
}

void remember(const SolverParams& params, const TimeStep& step, const SimulationState& before,
              std::span<const std::uint8_t> held, std::span<const Vec3> targets, SimulationState& after) {
  if (params.integrator != Integrator::Euler || params.step_error > 0) after.previous_seconds = step.h;
  if (params.integrator == Integrator::Bdf2) {
    after.previous_positions = before.positions;
    after.previous_velocities = before.velocities;
  }
  after.previous_accelerations = before.accelerations;
  after.accelerations.resize(after.velocities.size());
  for (std::size_t i = 0; i < after.velocities.size(); ++i)
    after.accelerations[i] = held[i] != 0 && params.integrator == Integrator::Newmark
                                 ? find_held_motion(params, before, i, targets[i], step.h).acceleration
                                 : Vec3((after.velocities[i] - step.base_velocities[i]) / step.seconds.velocity);
}

}  // namespace softreel
