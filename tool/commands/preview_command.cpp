#include <fmt/format.h>

#include "render/preview/preview.h"
#include "tool/commands/commands.h"
#include "tool/stages/outputs.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {

int run_preview(const ShotOptions& options) {
  if (options.dry_run) return run_plan(options);
  Session session(options);
  const Shot& shot = session.shot();
  const FrameSpan frames = session.frames();
  const std::unique_ptr<Preview> preview = make_egl_preview();
  session.console().info("preview on " + preview->description());
  Outputs outputs(shot.output.directory, shot.settings.name + ".preview", session.context().log);
  ShotRun run(shot, session.context());
  const SceneStage scenes(run);
  const auto exposure = static_cast<float>(shot.output.exposure);
  session.console().begin("frames", frames.count());
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    run.advance_to(frame);
    const Scene scene = scenes.at(frame, run.skin({true, 0, 1}));
    DisplayImage picture;
    {
      const ScopedStage stage(session.context().times, "preview");
      picture = preview->draw(scene, shot.render.params.width, shot.render.params.height, shot.output.view, exposure);
    }
    const StageKey key =
        KeyHasher("preview 1").add(picture_key(scene, shot.render.params)).add(shot.output.view).add(exposure).key();
    outputs.write(outputs.frame_path(frame, "png"), key, encode_png(picture));
    session.console().advance(frame - frames.first + 1, fmt::format("frame {}", frame));
  }
  RunReport report = session.report("preview", run, true);
  report.made.push_back(outputs.frame_path(frames.first, "png") + " .. " + outputs.frame_path(frames.last, "png"));
  session.finish(report);
  return 0;
}

}  // namespace softreel
