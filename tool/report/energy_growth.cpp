#include "tool/report/energy_growth.h"

#include <algorithm>

#include <fmt/format.h>

#include "tool/bodies/simulate_key.h"

namespace softreel {
namespace {

/// Fewer frames tell nothing.
constexpr int kFewFrames = 8;

double inner(const FrameEnergy& energy) {
  return energy.kinetic + energy.elastic;
}

/// The first frame from which on the constraints of a body stay as they are at the last one.
int first_quiet_frame(const Shot& shot, const BodyConstraints& constraints) {
  const int last = shot.settings.last_frame;
  const StageKey at_end = constraints_key(constraints, last);
  int quiet = last;
  while (quiet > shot.settings.first_frame && constraints_key(constraints, quiet - 1) == at_end) --quiet;
  return quiet;
}

/// Springs hold energy that is not counted.
bool has_springs(const BodyConstraints& constraints, double frame) {
  return std::any_of(constraints.pulls.begin(), constraints.pulls.end(),
                     [&](const Pull& pull) { return is_active(pull.active, frame) && pull.stiffness.at(frame) > 0; });
}

}  // namespace

std::optional<EnergyGrowth> find_growth(const BodyEnergies& energies, int quiet_from) {
  const auto begin = energies.frames.lower_bound(quiet_from), end = energies.frames.end();
  const auto count = std::distance(begin, end);
  if (count < kFewFrames) return std::nullopt;
  const auto middle = std::next(begin, count / 2);
  double before = 0;
  for (auto it = begin; it != middle; ++it) before = std::max(before, inner(it->second.energy));
  const auto most = std::max_element(
      middle, end, [](const auto& a, const auto& b) { return a.second.energy.total() < b.second.energy.total(); });
  const double gain = most->second.energy.total() - begin->second.energy.total();
  if (!(before > 0 && gain > before)) return std::nullopt;
  return EnergyGrowth{begin->first, most->first, before, inner(most->second.energy)};
}

std::vector<std::string> find_energy_growth(const ShotRun& run, const std::vector<BodyEnergies>& energies) {
  std::vector<std::string> lines;
  const Shot& shot = run.shot();
  if (shot.settings.mode == SimulationMode::Static) return lines;
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const BodyConstraints& constraints = run.simulation(b).constraints();
    const std::string& name = run.settings(b).name;
    const auto own = std::find_if(energies.begin(), energies.end(), [&](const auto& one) { return one.body == name; });
    if (own == energies.end() || has_springs(constraints, shot.settings.last_frame)) continue;  // or glue joins it
    if (const auto growth = find_growth(*own, first_quiet_frame(shot, constraints)))
      lines.push_back(fmt::format(
          "body '{}' gains energy from nothing: {:.3g} J of motion and deformation after frame {}, {:.3g} "
          "J at frame {}. The steps are too long for it. Use more solver.substeps, damping, or an integrator "
          "that damps (euler, bdf2).",
          name, growth->before, growth->first, growth->after, growth->last));
  }
  return lines;
}

}  // namespace softreel
