#include "tool/commands/picture_wishes.h"

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {
namespace {

bool is_whole(const Shot& shot, const FrameSpan& frames) {
  return frames.first == shot.settings.first_frame && frames.last == shot.settings.last_frame;
}

}  // namespace

void require_any_picture(const Shot& shot) {
  if (shot.output.png || shot.output.exr) return;
  throw input_error(
      fmt::format("{}: output.png = false, but output.exr is false too: there is no picture to make, and a movie is "
                  "made of the PNGs.\n  Accepted: one of them true. Remove output.png, or add --set output.png=true or "
                  "output.exr=true.",
                  shot.path));
}

void require_png(const Shot& shot, const std::string& what) {
  if (shot.output.png) return;
  throw input_error(
      fmt::format("{}: output.png = false, but {} is made of the PNGs.\n  Accepted: true. Remove the field, or add "
                  "--set output.png=true.",
                  shot.path, what));
}

bool makes_movie(const Shot& shot, const FrameSpan& frames) {
  return shot.output.movie && shot.output.png && is_whole(shot, frames) && frames.count() > 1;
}

void say_what_is_not_made(const Shot& shot, const FrameSpan& frames, const Log& log) {
  const OutputSettings& output = shot.output;
  if (!output.png && output.contact_sheet)
    log.info("no contact sheet: it is made of PNG pictures, and output.png = false");
  if (!output.movie) return;
  if (!output.png)
    log.info(kNoMovieWithoutPngs);
  else if (!is_whole(shot, frames))
    log.info(fmt::format("no movie: it is made when all frames, {} to {}, are asked for", shot.settings.first_frame,
                         shot.settings.last_frame));
}

}  // namespace softreel
