#include "tool/bodies/held_ranges.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/dynamics/frame_steps.h"
#include "tool/bodies/simulate_key.h"

namespace softreel {
namespace {

/// Where steps may end, per frame; 0 while the error dial has not chosen.
int ticks_per_frame(const Shot& shot) {
  if (shot.settings.mode == SimulationMode::Static) return 1;
  return shot.solver.substeps > 0 ? frame_grid(shot.solver).ticks_per_frame() : 0;
}

/// Of step number `tick`, as advance_to_frame reckons it.
double end_of_step(std::int64_t tick, int ticks) {
  const auto whole = static_cast<std::int64_t>(std::floor(static_cast<double>(tick) / ticks));
  return static_cast<double>(whole) + static_cast<double>(tick - whole * ticks) / ticks;
}

/// The first step that ends at `frame` or later.
std::int64_t first_step_from(double frame, int ticks) {
  auto tick = static_cast<std::int64_t>(std::ceil(frame * ticks)) - 1;
  while (end_of_step(tick, ticks) < frame) ++tick;
  return tick;
}

}  // namespace

std::vector<std::string> find_missed_ranges(const Shot& shot, const std::string& name,
                                            const std::vector<FrameRange>& active, bool grab) {
  std::vector<std::string> lines;
  const int ticks = ticks_per_frame(shot), start = first_simulated_frame(shot), last = shot.settings.last_frame;
  const auto is_outside = [&](const FrameRange& range) { return range.last < start || range.first > last; };
  if (!active.empty() && std::all_of(active.begin(), active.end(), is_outside))
    return {fmt::format("{} never holds: its active is out of the simulated frames, {} to {}.", name, start, last)};
  for (const FrameRange& range : active) {
    if (ticks == 0 || is_outside(range)) continue;
    const std::int64_t first = first_step_from(std::max<double>(range.first, start), ticks);
    const bool is_static = shot.settings.mode == SimulationMode::Static ||
                           (first == std::int64_t{start} * ticks && shot.settings.start == StartState::Equilibrium);
    const std::string which = fmt::format("{}: active = [{:g}, {:g}]", name, range.first, range.last);
    if (end_of_step(first, ticks) > range.last)
      lines.push_back(
          fmt::format("{} never holds: no step of time ends in it, with {} a frame. Make it longer.", which, ticks));
    else if (grab && !is_static && !is_active(active, end_of_step(first + 1, ticks)))
      lines.push_back(fmt::format(
          "{} grabs but never holds: the points are taken where a step ends in it, and the next step ends after it. "
          "Make it longer.",
          which));
  }
  return lines;
}

}  // namespace softreel
