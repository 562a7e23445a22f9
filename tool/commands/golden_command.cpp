#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "core/base/error.h"
#include "render/image/image_compare.h"
#include "render/pathtrace/path_tracer.h"
#include "tool/commands/commands.h"
#include "tool/stages/atomic_file.h"
#include "tool/stages/outputs.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {
namespace fs = std::filesystem;
namespace {

std::set<int> golden_frames(const Shot& shot) {
  const ShotSettings& settings = shot.settings;
  if (shot.golden.frames.empty())
    return {settings.first_frame, (settings.first_frame + settings.last_frame) / 2, settings.last_frame};
  for (const int frame : shot.golden.frames)
    if (frame < settings.first_frame || frame > settings.last_frame)
      throw input_error(
          fmt::format("{}: golden.frames has {}, which is no frame of the shot.\n  Accepted: {} to {}. Change "
                      "it, or shot.frames.",
                      shot.path, frame, settings.first_frame, settings.last_frame));
  return {shot.golden.frames.begin(), shot.golden.frames.end()};
}

/// Compares one picture with its golden image; leaves both and their difference in the output folder if it changed.
/// Returns a line that says the outcome, empty if the picture is the golden one or near enough.
std::string judge(const DisplayImage& picture, const std::string& golden_path, const Outputs& outputs, int frame,
                  double threshold) {
  if (!fs::exists(golden_path))
    return fmt::format("{}: there is no golden image. Look at the frame, then make one with --update.", golden_path);
  const DisplayImage golden = read_png(golden_path);
  const ImageDifference difference = compare(picture, golden);
  if (difference.identical || (difference.same_size && difference.block_error <= threshold)) return {};
  const std::string actual = outputs.frame_path(frame, "actual.png");
  write_file(actual, encode_png(picture));
  if (!difference.same_size)
    return fmt::format("{}: has {} x {} pixels, the frame has {} x {}; see {}", golden_path, golden.width,
                       golden.height, picture.width, picture.height, actual);
  write_file(outputs.frame_path(frame, "difference.png"), encode_png(difference_picture(picture, golden)));
  return fmt::format(
      "{}: changed: largest mean error of an 8 x 8 block {:.4f} (accepted: {}), at pixel ({}, {}); rmse "
      "{:.5f}; see {} and the difference beside it",
      golden_path, difference.block_error, threshold, difference.worst_x, difference.worst_y, difference.rmse, actual);
}

}  // namespace

int run_golden(const GoldenOptions& options) {
  if (options.shot.dry_run) return run_plan(options.shot);
  Session session(options.shot);
  const Shot& shot = session.shot();
  const Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
  const fs::path folder =
      options.reference.empty() ? fs::path(shot.path).parent_path() / "golden" : fs::path(options.reference);
  ShotRun run(shot, session.context());
  SceneStage scenes(run);
  PathTracer tracer(session.context().threads, session.context().times);
  const std::set<int> frames = golden_frames(shot);
  int done = 0, changed = 0;
  RunReport made;
  session.console().begin("golden frames", static_cast<int>(frames.size()));
  for (const int frame : frames) {
    const Scene scene = scenes.at(frame, run.skin(frame, skin_request(shot.render)));
    const Image image = tracer.render(scene, shot.render.params, [] { return cancellation().load(); });
    const DisplayImage picture = to_display(image, shot.output.view, static_cast<float>(shot.output.exposure));
    const std::string path = (folder / fmt::format("{}.{:04}.png", shot.settings.name, frame)).string();
    if (options.update) {
      write_file(path, encode_png(picture));
      made.made.push_back(path);
    } else if (const std::string verdict = judge(picture, path, outputs, frame, shot.golden.threshold);
               !verdict.empty()) {
      session.console().warn(verdict);
      ++changed;
    }
    session.console().advance(++done, fmt::format("frame {}", frame));
  }
  RunReport report = session.report("golden", run);
  report.pictures.traced = done;
  report.made = made.made;
  session.finish(report);
  if (changed > 0) throw work_error(fmt::format("{} of {} golden images changed.", changed, done));
  return 0;
}

}  // namespace softreel
