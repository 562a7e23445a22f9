/// Motions that gain energy from nothing: steps of time that are too long for what they follow.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tool/report/energy_history.h"

namespace softreel {

struct EnergyGrowth {
  int first = 0, last = 0;       ///< frames
  double before = 0, after = 0;  ///< J, of motion and deformation
};

/// Whether a body's total energy rises, in the second half of the frames from `quiet_from` on, by more than there was
/// in motion and deformation in the first: nothing works on it there, so that it could only fall.
std::optional<EnergyGrowth> find_growth(const BodyEnergies& energies, int quiet_from);

/// A line for each body of a dynamic shot of which that is so while its pins stand and no pull or glue acts.
std::vector<std::string> find_energy_growth(const ShotRun& run, const std::vector<BodyEnergies>& energies);

}  // namespace softreel
