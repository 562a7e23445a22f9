/// From one frame to the next in fixed steps, or in as many as the error of a step asks for.
#pragma once

#include <functional>

#include "core/dynamics/simulator.h"

namespace softreel {

/// With error control a frame is cut in `substeps` parts, each of them halved as often as max_substeps allows: every
/// step is a part or a half, quarter ... of it at a multiple of its length. So steps end exactly at parts and frames,
/// and the times at which constraints are looked up are known beforehand. They also end at the first and the last tick
/// at which a constraint is on, and where it jumps: it may be shorter than a step.
struct FrameGrid {
  int parts = 1;  ///< per frame
  int ticks = 1;  ///< per part, a power of two: the shortest steps; 1 without error control
  int ticks_per_frame() const { return parts * ticks; }
};
FrameGrid frame_grid(const SolverParams& params);

/// What the steps of a frame did.
struct FrameReport {
  StepReport last;           ///< of the last step that was tried
  int steps = 0;             ///< that count, at rest or not
  int steps_at_rest = 0;     ///< of these, not solved
  int steps_rejected = 0;    ///< solved in vain
  int kept_hierarchies = 0;  ///< steps that took those of an earlier one
  double kept_matrices = 0;  ///< sum over the steps of the shares of their matrices that were kept
  int linear_iterations = 0, nonlinear_iterations = 0;
  Index recovering_elements = 0;  ///< most in a step
  bool too_short = false;         ///< the shortest step's error was above SolverParams::step_error
  bool ok() const { return last.ok() && !too_short; }
};

/// Takes the simulator from frame - 1 to `frame` at `fps` frames a second. If a step fails, the state is that before
/// it. before_step: called before every solve, may throw; after_part: with the number of parts that are done, from 1.
FrameReport advance_to_frame(Simulator& simulator, int frame, double fps, const std::function<void()>& before_step,
                             const std::function<void(int)>& after_part);

}  // namespace softreel
