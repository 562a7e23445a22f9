#include "core/dynamics/frame_steps.h"

#include <algorithm>
#include <limits>

namespace softreel {
namespace {

/// A step is doubled where its error is this share of the limit or less: twice the length makes eight times the error
/// of an integrator of second order, and a step that is rejected was in vain.
constexpr double kGrowBelow = 0.1;

/// Ticks of the step after one of `length` that ended `done` ticks into the frame.
int next_length(const FrameGrid& grid, int done, int length, double error, double limit) {
  const bool may_grow = 2 * length <= grid.ticks && done % (2 * length) == 0;
  return may_grow && error <= kGrowBelow * limit ? 2 * length : length;
}

/// Ticks of the frame's first step, by the last step of the frame before.
int first_length(const FrameGrid& grid, const SimulationState& state, double fps, double limit) {
  if (state.previous_seconds == 0) return grid.ticks;
  int length = grid.ticks;
  const double tick = 1 / (fps * grid.ticks_per_frame());
  while (length > 1 && 0.75 * length * tick > state.previous_seconds) length /= 2;
  return next_length(grid, 0, length, state.previous_error, limit);
}

void count(FrameReport& total, const StepReport& step) {
  total.last = step;
  total.linear_iterations += step.solve.iterations;
  total.nonlinear_iterations += step.nonlinear_iterations;
  if (!step.ok()) return;
  total.recovering_elements = std::max(total.recovering_elements, step.recovery.elements);
  total.steps += step.rejected ? 0 : 1;
  total.steps_at_rest += step.at_rest ? 1 : 0;
  total.kept_hierarchies += step.kept_hierarchy ? 1 : 0;
  total.kept_matrices += step.kept_rows;
  total.steps_rejected += step.rejected ? 1 : 0;
}

}  // namespace

FrameGrid frame_grid(const SolverParams& params) {
  FrameGrid grid{params.substeps, 1};
  if (params.step_error == 0) return grid;
  while (2 * static_cast<std::int64_t>(grid.ticks_per_frame()) <= params.max_substeps) grid.ticks *= 2;
  return grid;
}

FrameReport advance_to_frame(Simulator& simulator, int frame, double fps, const std::function<void()>& before_step,
                             const std::function<void(int)>& after_part) {
  const SolverParams& params = simulator.params();
  const FrameGrid grid = frame_grid(params);
  const int all = grid.ticks_per_frame();
  const double limit = params.step_error > 0 ? params.step_error : std::numeric_limits<double>::infinity();
  FrameReport report;
  int length = first_length(grid, simulator.state(), fps, limit);
  for (int done = 0; done < all;) {
    before_step();
    const double end = frame - 1 + static_cast<double>(done + length) / all;
    const StepReport step = simulator.step(end, length / (fps * all), limit);
    count(report, step);
    if (!step.ok()) return report;
    if (step.rejected) {
      report.too_short = length == 1;
      if (report.too_short) return report;
      length /= 2;
      continue;
    }
    done += length;
    if (done % grid.ticks == 0) after_part(done / grid.ticks);
    length = next_length(grid, done, length, step.error, limit);
  }
  return report;
}

}  // namespace softreel
