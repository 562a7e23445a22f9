#include <fmt/format.h>

#include "tool/commands/commands.h"
#include "tool/commands/picture_wishes.h"
#include "tool/stages/frame_pipeline.h"

namespace softreel {

int run_sheet(const SheetCommandOptions& options) {
  if (options.shot.dry_run) return run_plan(options.shot);
  Session session(options.shot);
  const Shot& shot = session.shot();
  require_png(shot, "a sheet");
  const std::vector<int> frames = sheet_frames(session.frames().first, session.frames().last, options.sheet.count);
  ShotRun run(shot, session.context_beside());
  Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
  CacheUse& use = session.prepare(outputs, run);
  SceneStage scenes(run);
  PictureStage pictures(scenes, shot, outputs, session.context());
  for (const int frame : frames) pictures.remove_outdated(frame, frame);
  outputs.note_simulation();
  session.console().begin("frames", static_cast<int>(frames.size()));
  PictureCounts counts;
  int done = 0;
  for (const int frame : frames) {
    counts += make_pictures(run, scenes, pictures, frame, frame, use, [&](int made, PictureSource) {
      session.console().advance(++done, fmt::format("frame {}", made));
    });
    session.keep_within_limit();
  }
  const std::string sheet = make_sheet(shot, frames, options.sheet.columns, outputs, session.context());
  RunReport report = session.report("sheet", run);
  report.pictures = counts;
  report.made = {sheet};
  session.finish(report);
  return 0;
}

}  // namespace softreel
