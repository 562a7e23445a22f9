/// Which pictures a shot asks for, and what can be made of them.
#pragma once

#include <string>

#include "tool/commands/session.h"

namespace softreel {

inline constexpr const char* kNoMovieWithoutPngs = "no movie: it is made of PNG pictures, and output.png = false";

/// Throws input_error if the shot asks for neither PNG nor EXR: there would be nothing to render.
void require_any_picture(const Shot& shot);

/// Throws input_error if the shot asks for no PNGs, of which `what` is made: "a sheet".
void require_png(const Shot& shot, const std::string& what);

/// True if a movie is made: the shot asks for one and for PNGs, and these are all of its frames, more than one.
bool makes_movie(const Shot& shot, const FrameSpan& frames);

/// Says what of movie and contact sheet is not made although the shot asks for it, and why. `movie` is true by default,
/// and a shot that is written out says so: one that makes EXRs only is no mistake.
void say_what_is_not_made(const Shot& shot, const FrameSpan& frames, const Log& log);

}  // namespace softreel
