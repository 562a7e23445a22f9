#include "tool/stages/movie_stage.h"

#include <chrono>
#include <filesystem>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/timer.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/byte_hasher.h"
#include "tool/cache/process.h"

namespace softreel {
namespace {

/// The frames as ffmpeg's concat demuxer wants them: unlike its sequence pattern, it takes any number and, once it is
/// told that a name is no pattern either, any name.
std::string frame_list(int first, int last, const Outputs& outputs) {
  std::string list;
  for (int frame = first; frame <= last; ++frame) {
    std::string path = std::filesystem::absolute(outputs.frame_path(frame, "png")).string();
    for (std::size_t i = path.find('\''); i != std::string::npos; i = path.find('\'', i + 4))
      path.replace(i, 1, "'\\''");
    list += "file '" + path + "'\noption pattern_type none\n";
  }
  return list;
}

bool has_alpha(const Shot& shot) {
  return shot.ground && shot.ground->shadow_catcher;
}

/// What pictures go through: caught shadows over the grey of over_grey, as the encoder would drop what is transparent
/// and show the rest in full; even sizes, which H.264 wants; BT.709, which players take HD for, told or not; yuv420p,
/// which every player reads.
std::string filters(const Shot& shot) {
  const std::string over_grey =
      "format=rgba,split[grey][picture];[grey]lutrgb=r=128:g=128:b=128:a=255[below];[below][picture]overlay=format="
      "gbrp,";
  return (has_alpha(shot) ? over_grey : "") +
         "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p";
}

/// The file as ffmpeg takes it for no option and no address of a network, whatever its name.
std::string file_address(const std::string& path) {
  return "file:" + std::filesystem::absolute(path).string();
}

/// The words of a text without quotes.
void add_words(const std::string& text, std::vector<std::string>& words) {
  std::istringstream in(text);
  for (std::string word; in >> word;) words.push_back(word);
}

std::vector<std::string> ffmpeg_command(const Shot& shot, int frames, const std::string& list,
                                        const std::string& target) {
  std::vector<std::string> words;
  add_words(fmt::format("ffmpeg -hide_banner -loglevel error -y -r {} -f concat -safe 0 -i", shot.settings.fps), words);
  words.push_back(file_address(list));
  add_words(fmt::format("-frames:v {} -vf {}", frames, filters(shot)), words);
  // What the numbers mean: the pictures are sRGB.
  add_words("-colorspace bt709 -color_primaries bt709 -color_trc iec61966-2-1 -color_range tv", words);
  add_words("-c:v libx264 -crf 16 -preset medium -fflags +bitexact -flags:v +bitexact -movflags +faststart -f mp4",
            words);
  words.push_back(file_address(target));
  return words;
}

StageKey movie_key(const Shot& shot, int first, int last, const Outputs& outputs) {
  KeyHasher key("movie 3");
  key.add(shot.settings.fps);
  for (int frame = first; frame <= last; ++frame) {
    const auto entry = outputs.entry(outputs.frame_path(frame, "png"));
    key.add(entry ? entry->checksum : "");
  }
  return key.key();
}

}  // namespace

void require_movie_path(const Outputs& outputs) {
  const std::string path = std::filesystem::absolute(outputs.path("mp4")).string();
  if (path.find_first_of("\n\r") == std::string::npos) return;
  throw input_error(
      fmt::format("{}: no movie can be made there, for the path holds a line break, which ends a path in ffmpeg's list "
                  "of frames.\n  Accepted: paths of one line. Choose another --output or shot.name, or set "
                  "output.movie = false.",
                  path));
}

std::string make_movie(const Shot& shot, int first, int last, Outputs& outputs, const RunContext& context) {
  const std::string path = outputs.path("mp4");
  const StageKey key = movie_key(shot, first, last, outputs);
  if (outputs.is_done(path, key)) return path;
  const ScopedStage stage(context.times, "encode");
  const auto start = std::chrono::steady_clock::now();
  AtomicFile movie(path, AtomicFile::Writer::Others);
  AtomicFile list(path + ".frames", AtomicFile::Writer::Others);  // never committed: gone when the movie is made
  const std::string frames = frame_list(first, last, outputs);
  list.write(std::span(reinterpret_cast<const std::uint8_t*>(frames.data()), frames.size()));
  std::string said;
  const int status = run_process(ffmpeg_command(shot, last - first + 1, list.temporary_path(), movie.temporary_path()),
                                 &said, &context.cancelled);
  context.stop_if_cancelled();
  if (const std::string why = why_not_started(status); !why.empty())
    throw work_error(fmt::format(
        "{}: the movie was not made: the program ffmpeg {}.\n"
        "  All frames are there. Install the package ffmpeg, or see to that it can run, and run again (only the movie "
        "will be made); or set output.movie = false.",
        path, why));
  // ffmpeg ends with 0 even if it could not write the end of the file, but it says so.
  if (status != 0 || !said.empty())
    throw work_error(
        fmt::format("{}: the movie was not made: ffmpeg ended with status {}: {}\n  All frames are there. "
                    "Run again to try once more, or set output.movie = false.",
                    path, status, said));
  outputs.commit(movie, key, hash_file(movie.temporary_path()), seconds_since(start));
  return path;
}

bool is_movie_done(const Shot& shot, int first, int last, const Outputs& outputs) {
  return outputs.is_done(outputs.path("mp4"), movie_key(shot, first, last, outputs));
}

OutputState movie_state(const Shot& shot, int first, int last, const Outputs& outputs) {
  return outputs.state(outputs.path("mp4"), movie_key(shot, first, last, outputs));
}

bool is_movie_outdated(const Shot& shot, int first, int last, const Outputs& outputs) {
  return outputs.claimed_state(outputs.path("mp4"), movie_key(shot, first, last, outputs)) == OutputState::Stale;
}

}  // namespace softreel
