/// The time integrators in one form, which the solvers of a step share (design 4.4).
///
/// With the acceleration a, the velocity v and the positions x at the step's end,
///   v = base_velocities + seconds.velocity * a,   x = base_positions + seconds.position * v,   M a = f(x) - C v.
#pragma once

#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/dynamics/simulator.h"
#include "core/elasticity/step_terms.h"

namespace softreel {

/// The slope at the step's end of what was y0 at its start and yp a step before: (y - y0 - back (y0 - yp)) / seconds.
struct BackwardDifference {
  double seconds = 0, back = 0;
};

struct TimeStep {
  double h = 0;  ///< length of the step, s
  StepSeconds seconds;
  std::vector<Vec3> base_positions;   ///< per node, m
  std::vector<Vec3> base_velocities;  ///< per node, m/s
  BackwardDifference rate = {};       ///< for the damping of strains: of the integrator's order if the state knows more
  double turn_lag = 0;                ///< see find_turn_lag
};

/// BDF2 takes a step that has none before it in two stages: the method of Runge and Kutta of second order with one
/// solve a stage that damps what is too fast for the step (L-stable; Alexander 1977, "Diagonally implicit Runge-Kutta
/// methods for stiff O.D.E.'s"). The first is a step of Euler of this share g of the whole. The second goes from the
/// whole's start y0 and the first's end y1 as y = y0 + (1 / g - 1) (y1 - y0) + g h y'. With a step of Euler in its
/// place a spin lost 2.5 times the square of its turn a step, now 0.1 times that, and what falls from rest fell g h^2 /
/// 2 too far.
inline constexpr double kFirstStage = 1 - std::numbers::sqrt2 / 2;

/// True if the next step is to be taken in two stages.
bool takes_two_stages(const SolverParams& params, const SimulationState& state);

/// True if the step needs the accelerations at its start, and `state` does not hold them.
bool lacks_accelerations(const SolverParams& params, const SimulationState& state);

/// What of the state a jump of the forces spoils: BDF2 would keep the velocity of half a step before it for good, and
/// Newmark the forces of pins that let go.
void forget_before_jump(const SolverParams& params, std::span<const std::uint8_t> held,
                        std::span<const Vec3> accelerations, SimulationState& state);

enum class StepStage { Whole, First, Second };

/// What the integrator makes of the state for a step, or a stage of one, of h seconds. Before the second stage the
/// state's last step is the first.
TimeStep begin_time_step(const SolverParams& params, const SimulationState& state, double h, StepStage stage);

/// Of nodes that are held and reach `target`: the slope of their last two steps and the velocity at the end, by the
/// parabola through their last three places. So it is of second order and, unlike what Newmark would say of a given
/// motion, forgets a jump after two steps. Euler, and a first step: the mean velocity.
struct HeldNode {
  Vec3 velocity, acceleration;
};
HeldNode find_held_motion(const SolverParams& params, const SimulationState& state, std::size_t node,
                          const Vec3& target, double h);

/// Where the nodes would be after the step if nothing changed; the error is estimated by it.
std::vector<Vec3> predict_positions(const SolverParams& params, const SimulationState& state, double h);

/// Where Linearize::Predictor takes rotations and forces: of second order, and no farther along than one solve bears.
///
/// What the matrix leaves out of the tangent, nu beside the omega^2 in it, acts by the displacement from here to the
/// end: noise of the last steps comes back as nu / omega^2 times what extrapolation makes of it. Limits are by the
/// roots of the oscillator's recurrence, undamped and for equal steps.
///
/// - BDF2: x + h (v + u) / 2 with u the mean velocity over the last step, 4 times such noise. Stable from nu = -omega^2
///   to omega^2 / 4 where stiffness governs, to nu h^2 = 4 where mass does (4 / 9 in the units of tension.h). With any
///   less of v, oscillations grow of which the matrix has nothing; as it is they keep their size. predict_positions
///   would make 9 times the noise: stable from -0.4 omega^2 in compression to 1 / 9 in tension.
/// - Newmark: the line through the last two positions. It does not damp what is too fast for the step: there the
///   acceleration alternates and h^2 a / 2 is (omega h)^2 / 2 times the displacement, by which one solve was unstable
///   at ordinary steps (a bar under its weight at 24 a second). The line is at most three times the displacement. Where
///   a body is stretched and nothing damps it that is too much still: linearization has it iterate.
/// - Euler, and a first step: predict_positions.
std::vector<Vec3> linearization_positions(const SolverParams& params, const SimulationState& state, double h);

/// What turns evenly, by th in the step, is turned by th - lag th^3 at linearization_positions, to leading order. Where
/// rotations lag behind the end of the step, the forces that hold what spins together point ahead of its middle and
/// speed it up, by lag th^4 a step: a free plate at 0.26 rad a step gained a tenth of its energy in a second. So
/// find_step_rotations adds the lag to the turn since the step's start. By Taylor's series, with r the step over the
/// last one: x + h v lags by 1 / 3 and u in place of v by 1 / (6 r^2) + 1 / (2 r) more; BDF2's v is longer than the
/// velocity by (1 + 1 / r) th^2 / 6. 0 for Euler's steps, which take far more of a spin, and where one linearises at
/// the start or iterates.
double find_turn_lag(const SolverParams& params, const SimulationState& state, double h, StepStage stage);

/// Greatest estimated error of the free nodes' `positions` at the end of a step of h seconds from `state`, m.
double estimate_error(const SolverParams& params, const SimulationState& state, double h,
                      std::span<const std::uint8_t> held, std::span<const Vec3> positions);

/// The same of a step of two stages, by how the accelerations change from the end of the first to that of the second.
double estimate_staged_error(double h, std::span<const std::uint8_t> held, std::span<const Vec3> first_accelerations,
                             std::span<const Vec3> second_accelerations);

/// The integrator's and the solver's memory of `before`, in `after`. velocities of free nodes in `after` are those of
/// the step's end.
void remember(const SolverParams& params, const TimeStep& step, const SimulationState& before,
              std::span<const std::uint8_t> held, std::span<const Vec3> targets, SimulationState& after);

}  // namespace softreel
