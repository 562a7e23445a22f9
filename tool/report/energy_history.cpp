#include "tool/report/energy_history.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tool/bodies/body_frame_bytes.h"
#include "tool/cache/json_text.h"
#include "tool/cache/stage_names.h"

namespace softreel {
namespace {

using nlohmann::ordered_json;

/// Entry `index` of an array of numbers.
double number_at(const ordered_json& json, const char* name, std::size_t index) {
  return json.at(name).at(index).get<double>();
}

BodyEnergies body_from(const ordered_json& json) {
  BodyEnergies body;
  body.body = json.at("body").get<std::string>();
  const ordered_json& frames = json.at("frames");
  for (std::size_t i = 0; i < frames.size(); ++i)
    body.frames[frames.at(i).get<int>()] = {
        {number_at(json, "kinetic", i), number_at(json, "elastic", i), number_at(json, "gravity", i)},
        json.at("keys").at(i).get<std::string>()};
  return body;
}

/// Stored frames are read for their energies up to so many bytes: a moment after a crash, not minutes.
constexpr double kMostBytes = 1e9;

/// Fills in what a run that was killed has left: frames in the cache that no report tells of.
void read_stored(const ShotRun& run, std::size_t index, BodyEnergies& body) {
  const Cache& cache = run.context().cache;
  const BodySimulation& simulation = run.simulation(index);
  const ShotSettings& settings = run.shot().settings;
  double bytes = 0;
  for (int frame = settings.first_frame; frame <= settings.last_frame && bytes < kMostBytes; ++frame) {
    const StageKey& key = simulation.frame_key(frame);
    if (body.frames.count(frame) > 0 || !cache.has(kSimulationStage, key)) continue;
    std::error_code gone;
    const auto size = std::filesystem::file_size(cache.path(kSimulationStage, key), gone);
    bytes += gone ? 0 : static_cast<double>(size);
    if (!cache.damage(kSimulationStage, key).empty()) continue;  // whoever needs the frame says it and mends it
    const std::optional<FrameEnergy> energy = stored_energy(cache, key);
    if (!energy) return;  // an older softreel stored these: none of them will tell
    body.frames[frame] = {*energy, key};
  }
}

std::vector<BodyEnergies> energies_of_report(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return {};
  std::ostringstream text;
  text << in.rdbuf();
  const ordered_json report = ordered_json::parse(text.str(), nullptr, false);
  if (!report.is_object() || !report.contains("energies")) return {};
  return energies_from_json(json_text(report["energies"]));
}

}  // namespace

std::vector<BodyEnergies> find_energies(const ShotRun& run, const std::string& earlier_report) {
  const std::vector<BodyEnergies> earlier = energies_of_report(earlier_report);
  const ShotSettings& settings = run.shot().settings;
  std::vector<BodyEnergies> energies;
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const BodySimulation& simulation = run.simulation(b);
    const std::string& name = simulation.whole_name();
    const auto is_known = [&name](const BodyEnergies& one) { return one.body == name; };
    if (std::any_of(energies.begin(), energies.end(), is_known)) continue;  // glue joins it to an earlier body
    BodyEnergies body{name, {}};
    for (const BodyEnergies& one : earlier) {
      if (one.body != body.body) continue;
      for (const auto& [frame, known] : one.frames)
        if (frame >= settings.first_frame && frame <= settings.last_frame && known.key == simulation.frame_key(frame))
          body.frames[frame] = known;
    }
    for (const auto& [frame, energy] : simulation.energies())
      if (frame >= settings.first_frame) body.frames[frame] = {energy, simulation.frame_key(frame)};
    read_stored(run, b, body);
    energies.push_back(std::move(body));
  }
  return energies;
}

std::string energies_to_json(const std::vector<BodyEnergies>& energies) {
  ordered_json list = ordered_json::array();
  for (const BodyEnergies& body : energies) {
    ordered_json json{{"body", body.body}};
    for (const char* name : {"frames", "kinetic", "elastic", "gravity", "keys"}) json[name] = ordered_json::array();
    for (const auto& [frame, known] : body.frames) {
      json["frames"].push_back(frame);
      json["kinetic"].push_back(known.energy.kinetic);
      json["elastic"].push_back(known.energy.elastic);
      json["gravity"].push_back(known.energy.gravity);
      json["keys"].push_back(known.key);
    }
    list.push_back(std::move(json));
  }
  return json_text(list);
}

std::vector<BodyEnergies> energies_from_json(const std::string& text) {
  std::vector<BodyEnergies> energies;
  try {
    const ordered_json list = ordered_json::parse(text);
    if (!list.is_array()) return {};
    for (const ordered_json& body : list) energies.push_back(body_from(body));
  } catch (const nlohmann::json::exception&) {
    return {};  // of another program, or damaged: reports go without
  }
  return energies;
}

}  // namespace softreel
