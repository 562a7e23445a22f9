/// What a run made, what it skipped, and where the time went; as text for a person and as JSON for a program.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/timer.h"
#include "core/multigrid/multigrid.h"
#include "tool/report/energy_history.h"
#include "tool/stages/frame_pipeline.h"
#include "tool/stages/shot_run.h"

namespace softreel {

struct BodyReport {
  std::string name, mesh;
  std::int64_t vertices = 0, triangles = 0;
  std::int64_t nodes = 0, tets = 0;
  bool tets_from_cache = false;
  double tets_seconds = 0;  ///< what filling took, now or when it was stored
  std::vector<std::string> facts;
  std::optional<BodyDial> dial;  ///< what the error dial chose
  std::string dial_line;         ///< the same in words
  std::vector<LevelInfo> levels;
};

struct RunReport {
  std::string command, shot;
  int first_frame = 0, last_frame = 0, threads = 0;
  double seconds = 0;
  std::vector<BodyReport> bodies;
  SimulationCounts simulation;
  std::vector<BodyEnergies> energies;
  PictureCounts pictures;
  int files_written = 0, files_kept = 0;  ///< exported or previewed
  double files_saved_seconds = 0;         ///< what the kept ones took when they were made
  std::vector<std::string> made;          ///< files or patterns, in words: "out/a.0001.png .. out/a.0096.png"
  std::map<std::string, StageTimes::Entry> stages;
};

/// Facts of the run's bodies; those of the tetrahedra only where they were needed.
std::vector<BodyReport> report_bodies(const ShotRun& run);

/// What was skipped and what it took when it was made: "96 pictures (4 min 38 s)"; empty if nothing was.
std::vector<std::string> skipped_lines(const RunReport& report);

std::string to_text(const RunReport& report);
std::string to_json(const RunReport& report);

}  // namespace softreel
