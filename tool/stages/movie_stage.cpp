#include "tool/stages/movie_stage.h"

#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/stages/atomic_file.h"
#include "tool/stages/process.h"

namespace softreel {
namespace {

/// The image sequence pattern of ffmpeg has its own use for '%'.
std::string escaped(std::string path) {
  for (std::size_t i = path.find('%'); i != std::string::npos; i = path.find('%', i + 2)) path.insert(i, "%");
  return path;
}

std::vector<std::string> ffmpeg_command(const Shot& shot, int first, int last, const Outputs& outputs,
                                        const std::string& target) {
  const std::string pattern = escaped(outputs.path("")) + "%04d.png";
  return {"ffmpeg", "-hide_banner", "-loglevel", "error", "-y", "-framerate", fmt::format("{}", shot.settings.fps),
          "-start_number", std::to_string(first), "-i", pattern, "-frames:v", std::to_string(last - first + 1),
          // H.264 wants even sizes; yuv420p is what every player reads.
          "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,format=yuv420p", "-c:v", "libx264", "-crf", "16", "-preset", "medium",
          "-fflags", "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart", target};
}

StageKey movie_key(const Shot& shot, int first, int last, const Outputs& outputs) {
  KeyHasher key("movie 1");
  key.add(shot.settings.fps);
  for (int frame = first; frame <= last; ++frame) key.add(outputs.checksum(outputs.frame_path(frame, "png")));
  return key.key();
}

}  // namespace

std::string make_movie(const Shot& shot, int first, int last, Outputs& outputs, const RunContext& context) {
  const std::string path = outputs.path("mp4");
  const StageKey key = movie_key(shot, first, last, outputs);
  if (outputs.is_done(path, key)) return path;
  const ScopedStage stage(context.times, "encode");
  const std::string part =
      (std::filesystem::path(outputs.folder()) / ("." + outputs.shot_name() + ".part.mp4")).string();
  const std::string log = part + ".log";
  const int status = run_process(ffmpeg_command(shot, first, last, outputs, part), log);
  context.stop_if_cancelled();
  const std::vector<std::uint8_t> said = std::filesystem::exists(log) ? read_file(log) : std::vector<std::uint8_t>{};
  std::filesystem::remove(log);
  if (status != 0) {
    std::filesystem::remove(part);
    if (status == -1 || status == 127)
      throw work_error(fmt::format(
          "{}: the movie was not made: the program ffmpeg was not found.\n  All frames are there. Install the package "
          "ffmpeg and run again (only the movie will be made), or set output.movie = false.",
          path));
    throw work_error(
        fmt::format("{}: the movie was not made: ffmpeg ended with status {}: {}\n  All frames are there. "
                    "Run again to try once more, or set output.movie = false.",
                    path, status, std::string(said.begin(), said.end())));
  }
  std::filesystem::rename(part, path);
  outputs.enter(path, key);
  return path;
}

}  // namespace softreel
