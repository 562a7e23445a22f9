/// The jobs of a shot on a farm: simulate, then frames in chunks, then the movie, each after what it needs.
#pragma once

#include <compare>
#include <optional>
#include <string>
#include <vector>

namespace softreel {

/// Frames [first, last].
struct FrameChunk {
  int first = 0, last = 0;
  int count() const { return last - first + 1; }
  friend auto operator<=>(const FrameChunk&, const FrameChunk&) = default;
};

enum class FarmStep { Simulate, Frames, Movie };

/// "simulate", "frames", "movie".
const char* step_name(FarmStep step);

/// What of a shot is to be made.
struct FarmWork {
  std::optional<FrameChunk> simulate;  ///< none: all that the pictures need is in the cache
  std::vector<int> frames;             ///< whose pictures are missing, rising
  std::optional<FrameChunk> movie;     ///< frames of the movie or contact sheet; none: there is none to make
};

/// Tasks that ask the same of a node, submitted as one array.
struct FarmJob {
  FarmStep step = FarmStep::Simulate;
  int number = 0;                  ///< among the jobs of its step
  std::vector<FrameChunk> tasks;   ///< at least one; of Simulate and Movie exactly one
  std::vector<std::size_t> after;  ///< positions in the plan of the jobs that must have succeeded
};

/// "simulate", "frames", "frames-2" ..., "movie": a file name.
std::string job_name(const FarmJob& job);

/// "simulate", "frames-9-16", "movie": the task's name among all of the shot, a file name.
std::string task_name(FarmStep step, const FrameChunk& frames);

/// The frames in ranges without gaps of at most `size` frames, each run of frames in ranges as equal as can be.
std::vector<FrameChunk> chunks_of(const std::vector<int>& frames, int size);

/// Jobs in an order in which each comes after those that it needs; empty if there is nothing to do. most_tasks: of an
/// array (schedulers limit it); more frames make several jobs.
std::vector<FarmJob> plan_jobs(const FarmWork& work, int chunk, std::size_t most_tasks);

}  // namespace softreel
