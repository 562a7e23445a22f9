/// What of a shot is done, and why the rest is not: found from keys and checksums, without making anything.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "tool/bodies/run_context.h"
#include "tool/outputs/outputs.h"
#include "tool/shot/shot.h"

namespace softreel {

enum class Condition {
  Done,      ///< stored, whole, and of the shot as it is now
  Stale,     ///< there is one of the shot as it was
  Missing,   ///< there is none
  Damaged,   ///< it is there, but its checksum does not fit
  NotNeeded  ///< there is none, and all that would be made of it is done
};

/// A field whose change makes results stale.
struct StaleReason {
  std::string field;
  std::string before, after;  ///< as TOML, in short; empty: the field is not there

  friend auto operator<=>(const StaleReason&, const StaleReason&) = default;
};

/// One stage of one body, or one kind of files.
struct StageStatus {
  std::string stage;                             ///< "tetrahedra", "simulation", "pictures", "movie"
  std::string what;                              ///< name of the body; "png", "exr", "mp4"
  std::map<Condition, std::vector<int>> frames;  ///< rising; one entry (frame 0) for what is not made per frame
  bool per_frame = true;
  /// Why what is stale is: fields that change its key when they alone are put back, each with its stale frames. Empty
  /// if there is none, then:
  std::map<StaleReason, std::vector<int>> reasons;
  std::string cause = {};  ///< in words

  bool done() const {
    return std::all_of(frames.begin(), frames.end(), [](const auto& entry) {
      return entry.first == Condition::Done || entry.first == Condition::NotNeeded;
    });
  }
};

/// Reads and verifies everything that belongs to the shot's frames. `outputs`: of the shot's folder.
std::vector<StageStatus> find_status(const Shot& shot, Outputs& outputs, const RunContext& context);

/// "1-47, 60"
std::string frame_ranges(const std::vector<int>& frames);

}  // namespace softreel
