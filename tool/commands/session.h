/// Options that all shot commands share, and the objects they make: console, threads, cache, cancellation.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tool/bodies/run_context.h"
#include "tool/cache/cache_use.h"
#include "tool/commands/interruption.h"
#include "tool/outputs/outputs.h"
#include "tool/report/console.h"
#include "tool/report/run_report.h"
#include "tool/shot/shot.h"

namespace softreel {

struct ShotOptions {
  std::string shot;               ///< path of the shot file
  std::vector<std::string> sets;  ///< "path=value"
  std::string frames;             ///< "10-20" or "10"; empty: all of the shot
  std::string output;             ///< folder; empty: the shot's
  std::string cache;              ///< folder; empty: OUTPUT/.cache
  double cache_limit_gb = -1;     ///< below 0: the shot's
  int threads = 0;                ///< 0: the shot's
  bool quiet = false, json = false, dry_run = false;
};

struct FrameSpan {
  int first = 0, last = 0;
  int count() const { return last - first + 1; }
};

/// "10-20" or "10" within the shot's frames. Throws input_error for anything else, reversed and outside ranges too.
FrameSpan parse_frames(const std::string& text, const Shot& shot);

/// Reads the shot with its overrides and the options that stand for fields of it.
Shot load_shot_for(const ShotOptions& options);

/// One command's run over one shot. Members are made in order and refer to each other, so a session stays in place.
class Session {
 public:
  explicit Session(const ShotOptions& options, Cache::Storing storing = Cache::Storing::Wanted);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const Shot& shot() const { return shot_; }
  const FrameSpan& frames() const { return frames_; }
  /// Whether these are all frames of the shot.
  bool is_whole() const;
  Console& console() { return console_; }
  const RunContext& context() const { return context_; }
  /// The same with threads of their own, for work beside that of `context`.
  const RunContext& context_beside() const { return context_beside_; }

  /// Before files are made: throws work_error if the folder cannot be written, removes what killed runs left there,
  /// tells the manifest the settings that its files are made with, and the cache what the shot needs, for as long as
  /// the session lives. outputs: kept by reference until `finish`.
  CacheUse& prepare(Outputs& outputs, ShotRun& run);
  /// After all frames of the shot: removes the pictures of others that it once had, and says so.
  void remove_pictures_outside(Outputs& outputs);
  /// Everything that the cache keeps for the shot, pictures included.
  static std::vector<CacheItem> items(ShotRun& run, Outputs& outputs);
  /// Cuts the cache to its limit if it has grown by much since the last time.
  void keep_within_limit();
  /// Bytes; 0: none.
  double cache_limit() const;

  /// Fills in what every report has; the caller adds counts and files.
  RunReport report(const std::string& command, const ShotRun& run) const;
  /// Prints the report (JSON on standard output if asked for), and writes it and the resolved shot beside the output.
  void finish(const RunReport& report);

 private:
  std::string report_path() const;

  ShotOptions options_;
  Shot shot_;
  FrameSpan frames_;
  Console console_;
  Log log_;
  Threads threads_, threads_beside_;
  StageTimes times_;
  Cache cache_;
  RunContext context_, context_beside_;
  std::optional<CacheUse> use_;
  Outputs* outputs_ = nullptr;  ///< what was prepared; null: nothing is made
  std::int64_t stored_at_last_cut_ = 0;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace softreel
