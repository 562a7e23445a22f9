#include <fmt/format.h>

#include "tool/commands/commands.h"
#include "tool/stages/frame_pipeline.h"
#include "tool/stages/movie_stage.h"
#include "tool/stages/simulate_key.h"

namespace softreel {
namespace {

const char* note_of(PictureSource source) {
  switch (source) {
    case PictureSource::Kept:
      return "there already";
    case PictureSource::Recalled:
      return "from the cache";
    case PictureSource::Developed:
      return "developed again";
    case PictureSource::Linked:
      return "equal to another";
    case PictureSource::Traced:
      return "traced";
  }
  return "";
}

std::string made_line(const Outputs& outputs, const FrameSpan& frames, const std::string& extension) {
  return frames.count() == 1
             ? outputs.frame_path(frames.first, extension)
             : outputs.frame_path(frames.first, extension) + " .. " + outputs.frame_path(frames.last, extension);
}

std::vector<int> frames_of_sheet(const Session& session) {
  return sheet_frames(session.frames().first, session.frames().last, SheetOptions().count);
}

/// Nothing of an older shot stays under a name of this one: a killed run leaves no mixture.
void remove_outdated(const Session& session, PictureStage& pictures, Outputs& outputs) {
  const int removed = pictures.remove_outdated(session.frames().first, session.frames().last);
  if (removed > 0) session.context().log.info(fmt::format("{} outdated pictures removed", removed));
  const ShotSettings& settings = session.shot().settings;
  outputs.remove_if({outputs.path("mp4")}, [&](const std::string&) {
    return is_movie_outdated(session.shot(), settings.first_frame, settings.last_frame, outputs);
  });
  // One of the sheet command, of other frames or columns, goes with the pictures that it shows.
  outputs.remove_if({outputs.path("sheet.png")}, [&](const std::string& sheet) {
    return session.shot().output.contact_sheet
               ? is_sheet_outdated(session.shot(), frames_of_sheet(session), SheetOptions().columns, outputs)
               : removed > 0 && outputs.entry(sheet).has_value();
  });
}

}  // namespace

int run_render(const ShotOptions& options, RenderPart part) {
  if (part == RenderPart::Movie) return run_movie(options);
  if (options.dry_run) return run_plan(options);
  Session session(options);
  const Shot& shot = session.shot();
  const FrameSpan frames = session.frames();
  ShotRun run(shot, session.context_beside());
  Outputs outputs(session.shot().output.directory, session.shot().settings.name, session.context().log);
  CacheUse& use = session.prepare(outputs, run);
  SceneStage scenes(run);
  PictureStage pictures(scenes, shot, outputs, session.context());
  remove_outdated(session, pictures, outputs);
  outputs.note_simulation();
  session.console().begin("frames", frames.count());
  int done = 0;
  const PictureCounts counts =
      make_pictures(run, scenes, pictures, frames.first, frames.last, use, [&](int frame, PictureSource source) {
        session.console().advance(++done, fmt::format("frame {} {}", frame, note_of(source)));
        session.keep_within_limit();
      });
  std::vector<std::string> made;
  if (shot.output.png) made.push_back(made_line(outputs, frames, "png"));
  if (shot.output.exr) made.push_back(made_line(outputs, frames, "exr"));
  const bool whole = frames.first == shot.settings.first_frame && frames.last == shot.settings.last_frame;
  const bool all = part == RenderPart::All;
  if (all && shot.output.movie && shot.output.png && whole && frames.count() > 1)
    made.push_back(make_movie(shot, frames.first, frames.last, outputs, session.context()));
  if (all && shot.output.contact_sheet && shot.output.png)
    made.push_back(make_sheet(shot, frames_of_sheet(session), SheetOptions().columns, outputs, session.context()));
  RunReport report = session.report("render", run);
  report.pictures = counts;
  report.made = made;
  session.finish(report);
  return 0;
}

}  // namespace softreel
