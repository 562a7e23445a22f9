#include "core/dynamics/frame_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constraints/targets.h"

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

/// Where the steps of a frame must end, under error control, so that none misses a constraint that is shorter: the
/// first and the last tick at which one is on, and the first after it jumped. All is told by what holds at ticks, as
/// the keys of stored frames are.
class Stops {
 public:
  Stops(const FrameGrid& grid, int frame) : all_(grid.ticks_per_frame()), frame_(frame) {}

  template <typename IsOn>
  void add_switches(const IsOn& is_on) {
    bool before = is_on(time(0));
    for (int tick = 1; tick <= all_; ++tick) {
      const bool now = is_on(time(tick));
      if (now && !before) ticks_.push_back(tick);
      if (!now && before) ticks_.push_back(tick - 1);
      before = now;
    }
  }

  /// Keys of a constraint whose value jumps there, or, of a stiffness, comes from nothing or goes to it.
  template <typename T, typename IsOn>
  void add_keys(const Track<T>& track, const IsOn& is_on) {
    // Of the many keys of a captured motion only those of this frame.
    const auto first = std::upper_bound(track.keys.begin(), track.keys.end(), time(0),
                                        [](double frame, const Key<T>& key) { return frame < key.frame; });
    for (auto k = std::max<std::size_t>(1, static_cast<std::size_t>(first - track.keys.begin()));
         k < track.keys.size() && track.keys[k - 1].frame <= time(all_); ++k) {
      const Key<T>&from = track.keys[k - 1], &to = track.keys[k];
      if (from.value == to.value) continue;
      if (from.ease == Ease::Constant)
        add_key(to.frame, is_on);
      else if (is_nothing(to.value))
        add_key(from.frame, is_on);
      else if (is_nothing(from.value))
        add_key(to.frame, is_on);
    }
  }

  std::vector<int> sorted() && {
    std::sort(ticks_.begin(), ticks_.end());
    return std::move(ticks_);
  }

 private:
  static bool is_nothing(double stiffness) { return stiffness == 0; }
  static bool is_nothing(const Transform&) { return false; }

  double time(int tick) const { return frame_ - 1 + static_cast<double>(tick) / all_; }

  /// The first tick at or after it.
  template <typename IsOn>
  void add_key(double frame, const IsOn& is_on) {
    if (!(frame > time(0) && frame <= time(all_))) return;
    int tick = static_cast<int>(std::ceil((frame - (frame_ - 1)) * all_));
    while (tick > 1 && time(tick - 1) >= frame) --tick;
    while (tick < all_ && time(tick) < frame) ++tick;
    if (is_on(time(tick))) ticks_.push_back(tick);
  }

  int all_, frame_;
  std::vector<int> ticks_;
};

std::vector<int> find_stops(const BodyModel& model, const FrameGrid& grid, int frame) {
  Stops stops(grid, frame);
  if (grid.ticks == 1) return {};
  for (const Pin& pin : model.pins) {
    const auto is_on = [&pin](double at) { return is_active(pin.active, at); };
    stops.add_switches(is_on);
    stops.add_keys(pin.track, is_on);
  }
  for (const Pull& pull : model.pulls) {
    const auto is_on = [&pull](double at) { return pulling_range(pull, at) >= 0; };
    stops.add_switches(is_on);
    stops.add_keys(pull.track, is_on);
    stops.add_keys(pull.stiffness, is_on);
  }
  for (const Glue& glue : model.glues) {
    const auto is_on = [&glue](double at) { return is_sticking(glue, at); };
    stops.add_switches(is_on);
    stops.add_keys(glue.stiffness, is_on);
  }
  return std::move(stops).sorted();
}

/// The longest of `length`, its half, its quarter ... after which a step from `done` ends at the next stop or before.
int stopped_length(const std::vector<int>& stops, int done, int length) {
  const auto next = std::upper_bound(stops.begin(), stops.end(), done);
  while (next != stops.end() && done + length > *next) length /= 2;
  return length;
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
  const std::vector<int> stops = find_stops(simulator.model(), grid, frame);
  FrameReport report;
  int length = stopped_length(stops, 0, first_length(grid, simulator.state(), fps, limit));
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
    length = stopped_length(stops, done, next_length(grid, done, length, step.error, limit));
  }
  return report;
}

}  // namespace softreel
