#include <chrono>
#include <memory>

#include <fmt/format.h>

#include "render/preview/preview.h"
#include "tool/commands/commands.h"
#include "tool/stages/outputs.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"
#include "tool/stages/simulate_key.h"

namespace softreel {

namespace {

StageKey preview_key(const Shot& shot, const StageKey& look) {
  return KeyHasher("preview 3").add(look).add(shot.output.view).add(shot.output.exposure).key();
}

}  // namespace

int run_preview(const ShotOptions& options) {
  if (options.dry_run) return run_plan(options);
  Session session(options);
  const Shot& shot = session.shot();
  const FrameSpan frames = session.frames();
  Outputs outputs(shot.output.directory, shot.settings.name + ".preview", session.context().log);
  ShotRun run(shot, session.context());
  session.prepare(outputs, run);
  SceneStage scenes(run);
  std::unique_ptr<Preview> preview;  // made when the first frame has to be drawn
  int written = 0;
  double saved = 0;
  session.console().begin("frames", frames.count());
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    session.context().stop_if_cancelled();
    const std::string path = outputs.frame_path(frame, "png");
    const StageKey key = preview_key(shot, scenes.preview_key(frame));
    if (outputs.is_done(path, key)) {
      saved += outputs.entry(path)->seconds;
      session.console().advance(frame - frames.first + 1, fmt::format("frame {} there already", frame));
      continue;
    }
    if (!preview) {
      preview = make_egl_preview();
      session.console().info("preview on " + preview->description());
    }
    const Scene scene = scenes.at(frame, run.skin(frame, still_request(run.shot().render)));
    const auto start = std::chrono::steady_clock::now();
    const ScopedStage stage(session.context().times, "preview");
    const DisplayImage picture = preview->draw(scene, shot.render.params.width, shot.render.params.height,
                                               shot.output.view, static_cast<float>(shot.output.exposure));
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    outputs.write(path, key, encode_png(picture), seconds.count());
    ++written;
    session.console().advance(frame - frames.first + 1, fmt::format("frame {}", frame));
  }
  RunReport report = session.report("preview", run);
  report.files_written = written;
  report.files_kept = frames.count() - written;
  report.files_saved_seconds = saved;
  report.made.push_back(outputs.frame_path(frames.first, "png") + " .. " + outputs.frame_path(frames.last, "png"));
  session.finish(report);
  return 0;
}

}  // namespace softreel
