#include <functional>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/bodies/simulate_key.h"
#include "tool/commands/commands.h"
#include "tool/commands/picture_wishes.h"
#include "tool/stages/frame_pipeline.h"
#include "tool/stages/movie_stage.h"

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
  const auto remove_one = [&](const std::string& path, const std::function<bool(const std::string&)>& is_outdated) {
    if (outputs.remove_if({path}, is_outdated) > 0)
      session.context().log.info(fmt::format("{} removed: it is of other pictures", path));
  };
  remove_one(outputs.path("mp4"), [&](const std::string&) {
    return is_movie_outdated(session.shot(), settings.first_frame, settings.last_frame, outputs);
  });
  // One of the sheet command, of other frames or columns, goes with the pictures that it shows.
  remove_one(outputs.path("sheet.png"), [&](const std::string& sheet) {
    return session.shot().output.contact_sheet
               ? is_sheet_outdated(session.shot(), frames_of_sheet(session), SheetOptions().columns, outputs)
               : removed > 0 && outputs.entry(sheet).has_value();
  });
}

/// Another program that renders other settings into the same folder takes the names of these pictures for its own.
void require_own_pictures(const Session& session, const PictureStage& pictures, Outputs& outputs) {
  outputs.read_again();
  const auto [replaced, forgotten] = pictures.count_losses(session.frames().first, session.frames().last);
  if (replaced == 0 && forgotten == 0) return;
  if (replaced == 0)
    throw work_error(fmt::format(
        "{}: {} frames are gone: while this ran, the folder or its manifest was removed, or another softreel "
        "began to render other settings of the shot there.\n  Run the same again: it makes what is missing.",
        outputs.folder(), forgotten));
  throw work_error(
      fmt::format("{}: {} frames were replaced meanwhile by another softreel that renders other settings of the shot "
                  "there.\n  Give each an --output of its own, and run again.",
                  outputs.folder(), replaced));
}

}  // namespace

int run_render(const ShotOptions& options, RenderPart part) {
  if (part == RenderPart::Movie) return run_movie(options);
  if (options.dry_run) {
    require_any_picture(load_shot_for(options));
    return run_plan(options);
  }
  Session session(options);
  const Shot& shot = session.shot();
  require_any_picture(shot);
  const FrameSpan frames = session.frames();
  ShotRun run(shot, session.context_beside());
  Outputs outputs(session.shot().output.directory, session.shot().settings.name, session.context().log);
  const bool all = part == RenderPart::All;
  if (all && makes_movie(shot, frames)) require_movie_path(outputs);
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
  require_own_pictures(session, pictures, outputs);
  session.remove_pictures_outside(outputs);
  std::vector<std::string> made;
  if (shot.output.png) made.push_back(made_line(outputs, frames, "png"));
  if (shot.output.exr) made.push_back(made_line(outputs, frames, "exr"));
  if (all) say_what_is_not_made(shot, frames, session.context().log);
  if (all && makes_movie(shot, frames))
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
