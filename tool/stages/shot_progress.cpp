#include "tool/stages/shot_progress.h"

#include <algorithm>

#include "tool/cache/stage_names.h"
#include "tool/stages/movie_stage.h"
#include "tool/stages/sheet_stage.h"

namespace softreel {
namespace {

bool is_simulated(const ShotRun& run, int frame) {
  for (std::size_t b = 0; b < run.body_count(); ++b)
    if (!run.context().cache.has(kSimulationStage, run.simulation(b).frame_key(frame))) return false;
  return true;
}

bool is_filled(const ShotRun& run) {
  for (std::size_t b = 0; b < run.body_count(); ++b)
    if (!run.context().cache.has(kTetrahedraStage, run.simulation(b).filled_key())) return false;
  return true;
}

bool is_claimed(const PictureStage& pictures, const Outputs& outputs, int frame) {
  const std::vector<PictureStage::File> files = pictures.files(frame, pictures.trace_key(frame));
  return std::all_of(files.begin(), files.end(), [&](const PictureStage::File& file) {
    return outputs.claimed_state(file.path, file.key) == OutputState::Done;
  });
}

}  // namespace

ShotProgress find_progress(ShotRun& run, Outputs& outputs, int first, int last, Thoroughness how) {
  const Shot& shot = run.shot();
  const SceneStage scenes(run);
  const PictureStage pictures(scenes, shot, outputs, run.context());
  ShotProgress progress;
  progress.filled = is_filled(run);
  for (int frame = first; frame <= std::min(last + 1, shot.settings.last_frame); ++frame)
    if (!is_simulated(run, frame)) progress.not_simulated.push_back(frame);
  for (int frame = first; frame <= last; ++frame) {
    const bool there = how == Thoroughness::Content ? pictures.is_kept(frame) : is_claimed(pictures, outputs, frame);
    if (!there) progress.no_picture.push_back(frame);
  }
  const bool complete = progress.no_picture.empty();
  const bool whole = first == shot.settings.first_frame && last == shot.settings.last_frame && first < last;
  if (shot.output.png && shot.output.movie && whole)
    progress.movie_missing = !complete || !is_movie_done(shot, first, last, outputs);
  const SheetOptions sheet;
  if (shot.output.png && shot.output.contact_sheet)
    progress.sheet_missing =
        !complete || !is_sheet_done(shot, sheet_frames(first, last, sheet.count), sheet.columns, outputs);
  return progress;
}

}  // namespace softreel
