/// What lies beside golden images, so that a changed simulation is told from a changed renderer: SHOT.golden.json.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tool/outputs/outputs.h"
#include "tool/stages/shot_run.h"

namespace softreel {

/// The surface of one body at one frame.
struct GoldenSurface {
  std::int64_t vertices = 0;
  StageKey hash;              ///< of all positions in single precision, and of the triangles
  std::vector<Vec3f> sample;  ///< m, up to kGoldenSample vertices spread evenly over their numbers
};
inline constexpr std::size_t kGoldenSample = 512;

/// By body.
using GoldenGeometry = std::map<std::string, GoldenSurface>;

struct GoldenRecord {
  SettingsSnapshot settings;  ///< the shot without paths and output, and keys of the files it reads by their names
  std::map<int, GoldenGeometry> frames;
};

/// Number of the vertex that the k-th of a surface's samples is.
std::size_t sampled_vertex(std::size_t k, std::size_t vertices);

GoldenGeometry golden_geometry(const ShotRun& run, const std::vector<SkinnedBody>& bodies);
SettingsSnapshot golden_settings(const ShotRun& run);

std::string to_json(const GoldenRecord& record);
/// The record of a file; none if there is no such file. Throws input_error for one that is no record.
std::optional<GoldenRecord> read_golden_record(const std::string& path);

/// In words, why a frame may look different: "the simulation changed: of 512 vertices looked at, 'ball' 17 moved the
/// farthest, by 1.2 mm", "same geometry: the look changed: render.samples 8 -> 16", "same geometry, same shot: the
/// renderer changed".
struct GoldenCause {
  bool same_geometry = false;
  std::string words;
};

/// record, settings and geometry: what was written with the golden image, and what is now.
GoldenCause find_cause(const std::optional<GoldenRecord>& record, int frame, const SettingsSnapshot& settings,
                       const GoldenGeometry& geometry);

}  // namespace softreel
