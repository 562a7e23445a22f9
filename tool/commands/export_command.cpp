#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/commands/commands.h"
#include "tool/export/obj_export.h"
#include "tool/export/pc2_export.h"
#include "tool/export/ply_export.h"
#include "tool/stages/atomic_file.h"
#include "tool/stages/outputs.h"
#include "tool/stages/shot_run.h"

namespace softreel {
namespace {

/// A point cache that grows frame by frame under a temporary name.
struct CacheFile {
  CacheFile(const std::string& path, std::size_t points, const FrameSpan& frames)
      : file(path),
        writer({static_cast<Index>(points), frames.count(), static_cast<double>(frames.first), 1.0},
               [this](std::span<const std::uint8_t> bytes) { file.write(bytes); }) {}
  AtomicFile file;
  Pc2Writer writer;
};

/// Positions of the file's vertices at a frame, in the space asked for.
std::vector<Vec3> exported_positions(const LoadedBody& loaded, const std::vector<Vec3>& deformed,
                                     const std::string& space) {
  if (space == "world") return deformed;
  std::vector<Vec3> positions(deformed.size());
  for (std::size_t v = 0; v < deformed.size(); ++v)
    positions[v] = undo(loaded.placement, loaded.file_mesh.positions[v], loaded.surface.positions[v], deformed[v]);
  return positions;
}

std::string body_path(const Outputs& outputs, const std::string& body, const std::string& rest) {
  return outputs.path(fmt::format("{}.{}", body, rest));
}

void check_options(const ExportOptions& options) {
  if (options.format != "obj" && options.format != "ply" && options.format != "pc2")
    throw input_error(fmt::format("--format: \"{}\" is not known.\n  Accepted: obj, ply, pc2.", options.format));
  if (options.space != "object" && options.space != "world")
    throw input_error(
        fmt::format("--space: \"{}\" is not known.\n  Accepted: object (the file's own), world.", options.space));
}

}  // namespace

int run_export(const ExportOptions& options) {
  check_options(options);
  if (options.shot.dry_run) return run_plan(options.shot);
  Session session(options.shot);
  const Shot& shot = session.shot();
  const FrameSpan frames = session.frames();
  const Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
  ShotRun run(shot, session.context());
  std::vector<std::unique_ptr<CacheFile>> caches;
  std::vector<std::string> made;
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const std::string& name = run.settings(b).name;
    if (options.format == "pc2") {
      made.push_back(body_path(outputs, name, "pc2"));
      caches.push_back(std::make_unique<CacheFile>(made.back(), run.loaded(b).surface.positions.size(), frames));
    } else {
      made.push_back(
          body_path(outputs, name,
                    fmt::format("{:04}.{} .. {:04}.{}", frames.first, options.format, frames.last, options.format)));
    }
  }
  session.console().begin("frames", frames.count());
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    run.advance_to(frame);
    const std::vector<SkinnedBody> skinned = run.skin({false, 0, 1});
    const ScopedStage stage(session.context().times, "export");
    for (std::size_t b = 0; b < skinned.size(); ++b) {
      const LoadedBody& loaded = run.loaded(b);
      const auto positions = exported_positions(loaded, skinned[b].times.back().positions, options.space);
      const std::string path = body_path(outputs, run.settings(b).name, fmt::format("{:04}.{}", frame, options.format));
      if (options.format == "obj") write_file(path, encode_obj(loaded.file_mesh, positions));
      if (options.format == "ply") write_file(path, encode_ply(loaded.file_mesh, positions));
      if (options.format == "pc2") caches[b]->writer.append(positions);
    }
    session.console().advance(frame - frames.first + 1, fmt::format("frame {}", frame));
  }
  for (const auto& cache : caches) {
    cache->writer.finish();
    cache->file.commit();
  }
  RunReport report = session.report("export", run, true);
  report.made = made;
  session.finish(report);
  return 0;
}

}  // namespace softreel
