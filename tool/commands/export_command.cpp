#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/commands/commands.h"
#include "tool/export/obj_export.h"
#include "tool/export/pc2_export.h"
#include "tool/export/ply_export.h"
#include "tool/stages/atomic_file.h"
#include "tool/stages/outputs.h"
#include "tool/stages/shot_run.h"
#include "tool/stages/simulate_key.h"

namespace softreel {
namespace {

/// Positions of the file's vertices at a frame, in the space asked for.
std::vector<Vec3> exported_positions(const LoadedBody& loaded, const std::vector<Vec3>& deformed,
                                     const std::string& space) {
  if (space == "world") return deformed;
  std::vector<Vec3> positions(deformed.size());
  for (std::size_t v = 0; v < deformed.size(); ++v)
    positions[v] = undo(loaded.placement, loaded.file_mesh.positions[v], loaded.surface.positions[v], deformed[v]);
  return positions;
}

void check_options(const ExportOptions& options) {
  if (options.format != "obj" && options.format != "ply" && options.format != "pc2")
    throw input_error(fmt::format("--format: \"{}\" is not known.\n  Accepted: obj, ply, pc2.", options.format));
  if (options.space != "object" && options.space != "world")
    throw input_error(
        fmt::format("--space: \"{}\" is not known.\n  Accepted: object (the file's own), world.", options.space));
}

/// One body on its way to files.
class BodyExport {
 public:
  BodyExport(const ExportOptions& options, const FrameSpan& frames, ShotRun& run, std::size_t body, Outputs& outputs)
      : options_(options), frames_(frames), run_(run), body_(body), outputs_(outputs) {}

  std::string made_line() const {
    if (is_cache()) return path(frames_.first);
    return path(frames_.first) + " .. " + path(frames_.last);
  }

  /// True if the file that holds this frame is there, made of the same.
  bool is_kept(int frame) {
    if (!is_cache()) return outputs_.is_done(path(frame), key(frame));
    if (!kept_) kept_ = outputs_.is_done(path(frame), cache_key());
    return *kept_;
  }

  void write(int frame, const std::vector<Vec3>& deformed) {
    const auto start = std::chrono::steady_clock::now();
    const LoadedBody& loaded = run_.loaded(body_);
    const std::vector<Vec3> positions = exported_positions(loaded, deformed, options_.space);
    const auto seconds = [&] {
      seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      return seconds_;
    };
    if (is_cache()) {
      if (!cache_) cache_ = std::make_unique<PointCache>(path(frame), loaded.surface.positions.size(), frames_);
      cache_->writer.append(positions);
      seconds();
      return;
    }
    const Bytes bytes =
        options_.format == "obj" ? encode_obj(loaded.file_mesh, positions) : encode_ply(loaded.file_mesh, positions);
    seconds_ = 0;
    outputs_.write(path(frame), key(frame), bytes, seconds());
  }

  void finish() {
    if (!cache_) return;
    cache_->writer.finish();
    cache_->file.commit();
    outputs_.enter(path(frames_.first), cache_key(), seconds_);
  }

  double saved_seconds(int frame) const {
    const auto entry = outputs_.entry(path(frame));
    return entry ? entry->seconds : 0;
  }
  bool is_cache() const { return options_.format == "pc2"; }

 private:
  /// A point cache that grows frame by frame without a name.
  struct PointCache {
    PointCache(const std::string& path, std::size_t points, const FrameSpan& frames)
        : file(path),
          writer({static_cast<Index>(points), frames.count(), static_cast<double>(frames.first), 1.0},
                 [this](std::span<const std::uint8_t> bytes) { file.write(bytes); }) {}
    AtomicFile file;
    Pc2Writer writer;
  };

  std::string path(int frame) const {
    const std::string& name = run_.settings(body_).name;
    return is_cache() ? outputs_.path(fmt::format("{}.pc2", name))
                      : outputs_.path(fmt::format("{}.{:04}.{}", name, frame, options_.format));
  }

  StageKey key(int frame) const {
    const BodySimulation& simulation = run_.simulation(body_);
    return KeyHasher("export 2")
        .add(options_.format)
        .add(options_.space)
        .add(run_.loaded(body_).file_key)
        .add(run_.loaded(body_).key)
        .add(simulation.filled_key())
        .add(simulation.frame_key(frame))
        .key();
  }

  StageKey cache_key() const {
    KeyHasher all("point cache 2");
    for (int frame = frames_.first; frame <= frames_.last; ++frame) all.add(key(frame));
    return all.add(frames_.first).key();
  }

  const ExportOptions& options_;
  FrameSpan frames_;
  ShotRun& run_;
  std::size_t body_;
  Outputs& outputs_;
  std::optional<bool> kept_;
  std::unique_ptr<PointCache> cache_;
  double seconds_ = 0;
};

}  // namespace

int run_export(const ExportOptions& options) {
  check_options(options);
  if (options.shot.dry_run) return run_plan(options.shot);
  Session session(options.shot);
  const Shot& shot = session.shot();
  const FrameSpan frames = session.frames();
  Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
  ShotRun run(shot, session.context());
  session.prepare(outputs, run);
  outputs.note_simulation();
  std::vector<BodyExport> exports;
  for (std::size_t b = 0; b < run.body_count(); ++b) exports.emplace_back(options, frames, run, b, outputs);
  RunReport files;
  session.console().begin("frames", frames.count());
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    session.context().stop_if_cancelled();
    for (std::size_t b = 0; b < exports.size(); ++b) {
      BodyExport& one = exports[b];
      const bool counts = !one.is_cache() || frame == frames.first;
      if (one.is_kept(frame)) {
        files.files_kept += counts ? 1 : 0;
        files.files_saved_seconds += counts ? one.saved_seconds(frame) : 0;
        continue;
      }
      const SkinnedBody skinned = run.skin_body(b, frame, {false, 0, 1});
      const ScopedStage stage(session.context().times, "export");
      one.write(frame, skinned.times.back().positions);
      files.files_written += counts ? 1 : 0;
    }
    session.console().advance(frame - frames.first + 1, fmt::format("frame {}", frame));
  }
  RunReport report = session.report("export", run);
  for (BodyExport& one : exports) {
    one.finish();
    report.made.push_back(one.made_line());
  }
  report.files_written = files.files_written;
  report.files_kept = files.files_kept;
  report.files_saved_seconds = files.files_saved_seconds;
  session.finish(report);
  return 0;
}

}  // namespace softreel
