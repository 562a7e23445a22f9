/// What one implicit step works on beside the body itself; shared by the step's source files only.
#pragma once

#include <span>
#include <vector>

#include "core/constraints/pins.h"
#include "core/constraints/pulls.h"
#include "core/dynamics/simulator_parts.h"

namespace softreel {

struct StepWork {
  double h;
  PinnedNodes pinned;
  std::vector<ActivePull> pulls;
  std::vector<Quaternion> rotations;
  std::vector<Vec3> velocities;    ///< at the start; of held nodes, those that carry them to their targets
  std::vector<double> node_terms;  ///< mass part of S
  std::vector<Vec3> right_side, change;
  ElementTroubles troubles = {};  ///< in: of the step before; find_step_rotations counts this one
};

/// work.rotations at the step's start, shared where recovery acts; says in the log where it begins and ends.
RecoveryReport find_step_rotations(Simulator::Parts& parts, double frame, StepWork& work);

bool all_finite(std::span<const Vec3> vectors);

/// Moves each free piece (no pin, no pull) as a whole by what its total right side still asks for. Exact, because K
/// has no force against a translation: so the momentum of a free piece is right to round-off at any solver tolerance,
/// and its free fall needs no iteration.
void correct_translations(const Simulator::Parts& parts, StepWork& work);

/// True if a step of h seconds may be solved in float: its tolerance is not too tight, and no node is so much stiffer
/// than it is heavy that rounding its row to float would act like a force.
bool suits_float(Simulator::Parts& parts, double h);

/// Solves for work.change with the matrix in float and residuals in double; fills work.right_side. Not ok where float
/// does not do: then work.change means nothing, and the step is to be solved in double.
SolveReport solve_step_in_float(Simulator::Parts& parts, StepWork& work);

}  // namespace softreel
