/// The frames as a movie, encoded by the ffmpeg program.
#pragma once

#include <string>

#include "tool/bodies/run_context.h"
#include "tool/outputs/outputs.h"
#include "tool/shot/shot.h"

namespace softreel {

/// Throws input_error if ffmpeg cannot take the path of the movie and its frames: asked before long work.
void require_movie_path(const Outputs& outputs);

/// Encodes the PNG frames [first, last] to DIR/SHOT.mp4 (H.264); nothing to do if it is there, made of the same frames.
/// Returns its path. Throws work_error if ffmpeg is missing or fails, with what it said.
std::string make_movie(const Shot& shot, int first, int last, Outputs& outputs, const RunContext& context);

/// True if the movie is there, whole, and made of the frames as the manifest has them now.
bool is_movie_done(const Shot& shot, int first, int last, const Outputs& outputs);

/// The same, with the reason. Reads the movie.
OutputState movie_state(const Shot& shot, int first, int last, const Outputs& outputs);

/// True if a movie is there that was not made of the frames as the manifest has them now.
bool is_movie_outdated(const Shot& shot, int first, int last, const Outputs& outputs);

}  // namespace softreel
