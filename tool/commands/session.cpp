#include "tool/commands/session.h"

#include <charconv>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/base/timer.h"
#include "tool/bodies/shot_inputs.h"
#include "tool/bodies/simulate_key.h"
#include "tool/cache/atomic_file.h"
#include "tool/report/energy_growth.h"
#include "tool/shot/shot_load.h"
#include "tool/stages/picture_stage.h"
#include "tool/stages/settings_snapshot.h"

namespace softreel {
namespace {

/// A whole number that fills the text; false if it is none.
bool read_number(std::string_view text, int& value) {
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc() && end == text.data() + text.size();
}

}  // namespace

FrameSpan parse_frames(const std::string& text, const Shot& shot) {
  const FrameSpan all{shot.settings.first_frame, shot.settings.last_frame};
  if (text.empty()) return all;
  const auto dash = text.find('-', 1);
  FrameSpan span;
  const std::string accepted = fmt::format("Accepted: FIRST-LAST or one frame, within {}-{}.", all.first, all.last);
  if (!read_number(std::string_view(text).substr(0, dash), span.first) ||
      !read_number(dash == std::string::npos ? std::string_view(text) : std::string_view(text).substr(dash + 1),
                   span.last))
    throw input_error(fmt::format("--frames: \"{}\" is no range of frames.\n  {}", text, accepted));
  if (span.first > span.last)
    throw input_error(
        fmt::format("--frames: \"{}\" is reversed.\n  {} Write {}-{}.", text, accepted, span.last, span.first));
  if (span.first < all.first || span.last > all.last)
    throw input_error(fmt::format("--frames: \"{}\" leaves the frames of {}.\n  {} Widen shot.frames to go on.", text,
                                  shot.path, accepted));
  return span;
}

Shot load_shot_for(const ShotOptions& options) {
  std::vector<Override> overrides;
  for (const std::string& text : options.sets) overrides.push_back(parse_override(text));
  Shot shot = load_shot(options.shot, overrides);
  if (!options.output.empty()) shot.output.directory = options.output;
  if (options.threads > 0) shot.threads = options.threads;
  return shot;
}

Session::Session(const ShotOptions& options, Cache::Storing storing)
    : options_(options),
      shot_(load_shot_for(options)),
      frames_(parse_frames(options.frames, shot_)),
      console_(options.quiet ? Verbosity::Quiet : Verbosity::Normal, isatty(STDERR_FILENO) != 0),
      log_(console_.log()),
      threads_(shot_.threads, &cancellation()),
      threads_beside_(shot_.threads, &cancellation()),
      cache_(
          options.cache.empty() ? (std::filesystem::path(shot_.output.directory) / ".cache").string() : options.cache,
          storing, log_),
      context_{threads_, log_, times_, cache_, cancellation()},
      context_beside_{threads_beside_, log_, times_, cache_, cancellation()},
      start_(std::chrono::steady_clock::now()) {
  console_.debug(fmt::format("{}: frames {} to {}, {} bodies, {} materials, {} lights", shot_.path, frames_.first,
                             frames_.last, shot_.bodies.size(), shot_.materials.size(), shot_.lights.size()));
  for (const std::string& set : options_.sets) console_.debug("--set " + set);
  for (const BodySettings& body : shot_.bodies) console_.debug(fmt::format("body {}: {}", body.name, body.mesh));
  console_.debug(fmt::format("output to {}, results kept in {}, {} threads", shot_.output.directory, cache_.folder(),
                             threads_.count()));
}

std::vector<CacheItem> Session::items(ShotRun& run, Outputs& outputs) {
  const ShotSettings& settings = run.shot().settings;
  const SceneStage scenes(run);
  const PictureStage pictures(scenes, run.shot(), outputs, run.context());
  std::vector<CacheItem> items = run.items(first_simulated_frame(run.shot()), settings.last_frame);
  for (CacheItem& item : pictures.items(settings.first_frame, settings.last_frame)) items.push_back(std::move(item));
  return items;
}

bool Session::is_whole() const {
  return frames_.first == shot_.settings.first_frame && frames_.last == shot_.settings.last_frame;
}

CacheUse& Session::prepare(Outputs& outputs, ShotRun& run) {
  require_writable(outputs.folder());
  sweep_temporaries(outputs.folder());
  outputs.set_settings(snapshot(run));
  outputs.protect(files_read(run.shot()));
  outputs_ = &outputs;
  use_.emplace(cache_, shot_.path, shot_.output.directory);
  use_->claim(items(run, outputs));
  return *use_;
}

void Session::remove_pictures_outside(Outputs& outputs) {
  if (!is_whole()) return;
  const int removed = outputs.remove_pictures_outside(frames_.first, frames_.last);
  if (removed > 0)
    log_.info(fmt::format("{} outdated pictures removed: they are of frames that the shot no longer has", removed));
}

double Session::cache_limit() const {
  if (options_.cache_limit_gb >= 0) return options_.cache_limit_gb * 1e9;
  // A cache that others share is theirs too: it is cut on request only.
  return options_.cache.empty() ? shot_.output.cache_limit_gb * 1e9 : 0;
}

void Session::keep_within_limit() {
  const double limit = cache_limit();
  if (limit == 0 || static_cast<double>(cache_.stored_bytes() - stored_at_last_cut_) < limit / 16) return;
  stored_at_last_cut_ = cache_.stored_bytes();
  cut_cache(cache_, limit);
}

RunReport Session::report(const std::string& command, const ShotRun& run) const {
  RunReport report;
  report.command = command;
  report.shot = shot_.path;
  report.first_frame = frames_.first;
  report.last_frame = frames_.last;
  report.threads = threads_.count();
  report.seconds = seconds_since(start_);
  report.bodies = report_bodies(run);
  report.simulation = run.counts(frames_.last);
  report.energies = find_energies(run, report_path());
  for (const std::string& line : find_energy_growth(run, report.energies)) log_.warn(line);
  report.stages = times_.entries();
  return report;
}

std::string Session::report_path() const {
  return (std::filesystem::path(shot_.output.directory) / (shot_.settings.name + ".report.json")).string();
}

void Session::finish(const RunReport& report) {
  console_.end();
  for (const auto& [stage, entry] : report.stages)
    console_.debug(fmt::format("stage {}: {:.3f} s in {} calls", stage, entry.seconds, entry.calls));
  if (const double limit = cache_limit(); limit > 0 && cache_.stored_bytes() > 0) {
    const CacheRemoval removal = cut_cache(cache_, limit);
    if (!removal.problem.empty())
      console_.warn(removal.problem);
    else if (const double bytes = cache_size(cache_); bytes > limit)
      console_.warn(
          fmt::format("{}: the results of this shot that the cache holds need {}, more than its limit of {}; "
                      "none of them was removed. Raise --cache-limit or output.cache_limit.",
                      cache_.folder(), format_bytes(bytes), format_bytes(limit)));
  }
  use_.reset();
  // Not after some of the frames: a farm has many such runs, and the manifest is as long as the shot.
  if (outputs_ != nullptr && is_whole()) outputs_->fold();
  const std::filesystem::path folder(shot_.output.directory);
  const std::string resolved = (folder / (shot_.settings.name + ".resolved.toml")).string();
  std::error_code none;
  if (!std::filesystem::equivalent(resolved, shot_.path, none)) write_file(resolved, to_toml(shot_));  // it was given
  write_file(report_path(), to_json(report) + "\n");
  if (options_.json) {
    std::printf("%s\n", to_json(report).c_str());
  } else if (!options_.quiet) {
    std::printf("%s: %s\n%s", report.command.c_str(), shot_.settings.name.c_str(), to_text(report).c_str());
  }
}

}  // namespace softreel
