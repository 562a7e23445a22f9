#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/commands/commands.h"
#include "tool/commands/picture_wishes.h"
#include "tool/farm/shell_text.h"
#include "tool/stages/movie_stage.h"
#include "tool/stages/picture_stage.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/sheet_stage.h"
#include "tool/stages/shot_run.h"
#include "tool/stages/shot_status.h"

namespace softreel {
namespace {

/// Throws unless the pictures of the shot as it is now are there, whole.
void require_pictures(const Session& session, const PictureStage& pictures) {
  std::vector<int> missing;
  for (int frame = session.frames().first; frame <= session.frames().last; ++frame)
    if (!pictures.is_kept(frame)) missing.push_back(frame);
  if (missing.empty()) return;
  throw work_error(
      fmt::format("{}: pictures of the shot as it is now are missing: frames {}. Nothing was made of the others.\n"
                  "  {} makes them.",
                  session.shot().output.directory, frame_ranges(missing),
                  shell_command({"softreel", "render", session.shot().path})));
}

/// What the shot asks for; throws if that is nothing.
struct Wanted {
  bool movie = false, sheet = false;
};
Wanted find_wanted(const Session& session) {
  const Shot& shot = session.shot();
  const FrameSpan& frames = session.frames();
  const Wanted wanted{makes_movie(shot, frames), shot.output.png && shot.output.contact_sheet};
  if (!wanted.movie && !wanted.sheet)
    throw input_error(fmt::format(
        "{}: --only movie: the shot asks for no movie of these frames and for no contact sheet.\n  Accepted: "
        "output.movie = true with all frames of a shot of more than one, or output.contact_sheet = true; and "
        "output.png = true.",
        shot.path));
  return wanted;
}

}  // namespace

int run_movie(const ShotOptions& options) {
  Session session(options);
  const Shot& shot = session.shot();
  const FrameSpan frames = session.frames();
  const Wanted wanted = find_wanted(session);
  ShotRun run(shot, session.context(), DialUse::LookUp);
  Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
  if (wanted.movie) require_movie_path(outputs);
  session.prepare(outputs, run);
  const SceneStage scenes(run);
  const PictureStage pictures(scenes, shot, outputs, session.context());
  require_pictures(session, pictures);
  session.remove_pictures_outside(outputs);
  std::vector<std::string> made;
  if (wanted.movie) made.push_back(make_movie(shot, frames.first, frames.last, outputs, session.context()));
  const SheetOptions sheet;
  if (wanted.sheet)
    made.push_back(make_sheet(shot, sheet_frames(frames.first, frames.last, sheet.count), sheet.columns, outputs,
                              session.context()));
  RunReport report = session.report("render", run);
  report.pictures.kept = frames.count();
  report.made = std::move(made);
  session.finish(report);
  return 0;
}

}  // namespace softreel
