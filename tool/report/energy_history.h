/// Energies of the bodies over the frames, for reports: of this run, and of earlier ones of the same simulation.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tool/stages/shot_run.h"

namespace softreel {

struct BodyEnergies {
  struct Frame {
    FrameEnergy energy;
    StageKey key;  ///< of the simulated frame
  };
  std::string body;
  std::map<int, Frame> frames;  ///< those that are known
};

/// Energies at the frames of the shot. A run that only continues computes few of them: the others are taken from the
/// report at `earlier_report` (of an earlier run, if there is one), where their keys are those of the shot as it is
/// now.
std::vector<BodyEnergies> find_energies(const ShotRun& run, const std::string& earlier_report);

/// As an array of JSON, one object a body with one array a quantity; and back. Reading throws nothing: what is no such
/// array gives no energies.
std::string energies_to_json(const std::vector<BodyEnergies>& energies);
std::vector<BodyEnergies> energies_from_json(const std::string& text);

}  // namespace softreel
