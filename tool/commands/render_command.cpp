#include <fmt/format.h>

#include "tool/commands/commands.h"
#include "tool/stages/movie_stage.h"
#include "tool/stages/outputs.h"
#include "tool/stages/picture_stage.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {
namespace {

void count(RunReport& report, PictureSource source) {
  if (source == PictureSource::Traced) ++report.pictures_traced;
  if (source == PictureSource::Linked) ++report.pictures_linked;
  if (source == PictureSource::Done) ++report.pictures_kept;
}

const char* note_of(PictureSource source) {
  if (source == PictureSource::Traced) return "traced";
  return source == PictureSource::Linked ? "copied" : "there already";
}

std::string made_line(const Outputs& outputs, const FrameSpan& frames, const std::string& extension) {
  return frames.count() == 1
             ? outputs.frame_path(frames.first, extension)
             : outputs.frame_path(frames.first, extension) + " .. " + outputs.frame_path(frames.last, extension);
}

}  // namespace

int run_render(const ShotOptions& options) {
  if (options.dry_run) return run_plan(options);
  Session session(options);
  const Shot& shot = session.shot();
  const FrameSpan frames = session.frames();
  Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
  ShotRun run(shot, session.context());
  const SceneStage scenes(run);
  PictureStage pictures(shot, outputs, session.context());
  RunReport counts;
  session.console().begin("frames", frames.count());
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    run.advance_to(frame);
    const PictureSource source = pictures.make(frame, scenes.at(frame, run.skin(skin_request(shot.render))));
    count(counts, source);
    session.console().advance(frame - frames.first + 1, fmt::format("frame {} {}", frame, note_of(source)));
  }
  if (shot.output.png) counts.made.push_back(made_line(outputs, frames, "png"));
  if (shot.output.exr) counts.made.push_back(made_line(outputs, frames, "exr"));
  const bool whole = frames.first == shot.settings.first_frame && frames.last == shot.settings.last_frame;
  if (shot.output.movie && shot.output.png && whole && frames.count() > 1)
    counts.made.push_back(make_movie(shot, frames.first, frames.last, outputs, session.context()));
  RunReport report = session.report("render", run, true);
  report.pictures_traced = counts.pictures_traced;
  report.pictures_linked = counts.pictures_linked;
  report.pictures_kept = counts.pictures_kept;
  report.made = counts.made;
  session.finish(report);
  return 0;
}

}  // namespace softreel
