/// What one implicit step works on beside the body itself; shared by the step's source files only.
#pragma once

#include <span>
#include <vector>

#include "core/constraints/pins.h"
#include "core/constraints/pulls.h"
#include "core/dynamics/simulator_parts.h"
#include "core/dynamics/time_step.h"

namespace softreel {

/// One step on its way. The system is linear in the velocities v at the end, which are `velocities` plus `change`.
struct StepWork {
  TimeStep step;
  PinnedNodes pinned;
  std::vector<ActivePull> pulls;
  std::vector<Vec3> positions;        ///< where rotations, forces and stiffness are taken, m
  std::vector<Quaternion> rotations;  ///< at these positions
  std::vector<Vec3> offsets;          ///< the integrator's base positions less `positions`, m; empty if they are equal
  std::vector<Vec3> velocities;       ///< the integrator's base; of held nodes, those at the end
  std::vector<double> node_terms;     ///< mass part of S
  std::vector<Vec3> right_side, change;
  ElementTroubles troubles = {};  ///< in: of the step before; find_step_rotations counts this one
  double kept_change = -1;        ///< StepSource::kept_change
  std::vector<GlueBond> bonds = {};
  std::uint64_t constraints = 0;  ///< SimulationState::constraints
};

/// t f + M (base velocities) - (M + t C) v - t (K + G) (seconds.position v + offsets) for v = velocities + change and t
/// = seconds.velocity; zero on held nodes. change: empty if it is zero; end_velocities: v. On the way parts.step_terms.
void find_residual(Simulator::Parts& parts, const StepWork& work, std::span<const Vec3> end_velocities,
                   std::span<const Vec3> change, std::span<Vec3> residual);
/// work.rotations at work.positions, shared where recovery acts; says in the log where it begins and ends.
RecoveryReport find_step_rotations(Simulator::Parts& parts, double frame, StepWork& work);

bool all_finite(std::span<const Vec3> vectors);

/// Moves each free piece (no pin, no pull) as a whole by what its total right side still asks for. Exact, because K
/// has no force against a translation: so the momentum of a free piece is right to round-off at any solver tolerance,
/// and its free fall needs no iteration.
void correct_translations(const Simulator::Parts& parts, StepWork& work);

/// The greatest ratio of stiffness to mass in this step, over the greatest for which float, and a residual relative to
/// all of the right side, are good enough.
double rigidity_beyond_float(Simulator::Parts& parts, const StepWork& work);

/// True if such a step may be solved in float: its tolerance is not too tight, and no node is so much stiffer
/// than it is heavy that rounding its row to float would act like a force.
bool suits_float(Simulator::Parts& parts, const StepWork& work);

/// Solves for work.change with the matrix in float and residuals in double; fills work.right_side. Not ok where float
/// does not do: then work.change means nothing, and the step is to be solved in double. step: gets what was kept.
SolveReport solve_step_in_float(Simulator::Parts& parts, StepWork& work, StepReport& step);

/// The system in double: for tolerances that float does not reach, and where it failed. Rigid motions of a very stiff
/// part, and what is soft beside it, have rows that are small beside those of its stiffness. A residual relative to all
/// of the right side has to be smaller by as much, or they are hardly solved, which acts like forces on them: blocks
/// 1e8 times as stiff as those between them flew apart. A body that is all of one stiffness is solved tighter with
/// them. Where that does not come to an end, the tolerance that was asked for is enough.
SolveReport solve_step_in_double(Simulator::Parts& parts, StepWork& work);

/// Finds work.change, and the rotations at the step's end, by Newton to force balance; work.right_side becomes the
/// unbalanced forces.
StepReport iterate_step(Simulator::Parts& parts, StepWork& work);

/// True if a step would change nothing worth a step: see SolverParams::rest_tolerance.
bool is_at_rest(Simulator::Parts& parts, const PinnedNodes& pinned, const std::vector<ActivePull>& pulls);

}  // namespace softreel
