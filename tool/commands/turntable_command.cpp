// A turntable: the shot at one frame, with the camera on a circle round what it looks at.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/base/timer.h"
#include "tool/commands/commands.h"
#include "tool/commands/picture_wishes.h"
#include "tool/stages/movie_stage.h"
#include "tool/stages/picture_stage.h"

namespace softreel {
namespace {

/// One moment: motion blur would be that of the body, not of the turning.
SkinRequest moment_of(const RenderSettings& render) {
  SkinRequest request = skin_request(render);
  request.shutter = 0;
  request.next = false;
  return request;
}

/// The camera after a share of a turn about the vertical through its target, to its right.
Camera turned(Camera camera, double share) {
  const auto angle = static_cast<float>(2 * std::numbers::pi * share);
  const Eigen::AngleAxisf turn(angle, Vec3f::UnitY());
  camera.position = camera.target + turn * (camera.position - camera.target);
  camera.up = turn * camera.up;  // one that looks straight down turns about its view
  return camera;
}

StageKey file_key(const char* extension, const StageKey& content, const Shot& shot, const BurnIn& words) {
  KeyHasher key(fmt::format("turntable {} 2", extension));
  key.add(content).add(shot.output.view).add(shot.output.exposure).add(shot.output.burn_in);
  if (shot.output.view == ViewTransform::Raw) key.add("linear");
  if (shot.output.burn_in) key.add(words.left).add(words.right);
  return key.key();
}

/// The pictures of one turntable on their way to files.
class Turntable {
 public:
  Turntable(Session& session, const SceneStage& scenes, Outputs& outputs)
      : session_(session), scenes_(scenes), outputs_(outputs) {}

  /// No picture of another turn or an older shot stays beside those of these contents, of the kinds that are made now:
  /// a killed run leaves no mixture.
  void remove_outdated(const std::vector<StageKey>& contents) {
    const auto count = static_cast<int>(contents.size());
    std::map<std::string, StageKey> keys;  // by path
    std::set<std::filesystem::path> extensions;
    for (int picture = 1; picture <= count; ++picture)
      for (const File& file : files(picture, count, contents[static_cast<std::size_t>(picture - 1)])) {
        keys[file.path] = file.key;
        extensions.insert(std::filesystem::path(file.path).extension());
      }
    for (const std::string& path : outputs_.paths())
      if (extensions.contains(std::filesystem::path(path).extension()))
        keys.emplace(path, StageKey());  // of no key now
    outputs_.remove_outdated(keys);
    outputs_.remove_if({outputs_.path("mp4")},
                       [&](const std::string&) { return is_movie_outdated(session_.shot(), 1, count, outputs_); });
  }

  /// Writes the files of a picture unless they are there. True if it was traced.
  bool make(int picture, int count, const Scene& scene, const StageKey& content) {
    const Shot& shot = session_.shot();
    const std::vector<File> wanted = files(picture, count, content);
    if (std::all_of(wanted.begin(), wanted.end(),
                    [&](const File& file) { return outputs_.is_done(file.path, file.key); })) {
      double seconds = 0;
      for (const File& file : wanted)
        if (const auto entry = outputs_.entry(file.path)) seconds = std::max(seconds, entry->seconds);
      saved_seconds_ += seconds;
      return false;
    }
    const auto start = std::chrono::steady_clock::now();
    if (!tracer_) tracer_ = std::make_unique<PathTracer>(session_.context().threads, session_.context().times);
    const Image image = tracer_->render(scene, shot.render.params, [] { return cancellation().load(); });
    const double seconds = seconds_since(start);
    for (const File& file : wanted) {
      const bool is_exr = file.extension == std::string_view("exr");
      outputs_.write(file.path, file.key, is_exr ? encode_exr(image) : encode_display(image, words(picture, count)),
                     seconds);
    }
    return true;
  }
  /// What the pictures that were there took when they were made.
  double saved_seconds() const { return saved_seconds_; }

 private:
  struct File {
    const char* extension;
    std::string path;
    StageKey key;
  };

  BurnIn words(int picture, int count) const {
    return {session_.shot().settings.name, fmt::format("{} / {}", picture, count)};
  }

  std::vector<File> files(int picture, int count, const StageKey& content) const {
    const Shot& shot = session_.shot();
    std::vector<File> files;
    for (const auto& [extension, wanted] : {std::pair("exr", shot.output.exr), std::pair("png", shot.output.png)})
      if (wanted)
        files.push_back({extension, outputs_.frame_path(picture, extension),
                         file_key(extension, content, shot, words(picture, count))});
    return files;
  }

  std::vector<std::uint8_t> encode_display(const Image& image, const BurnIn& words) const {
    const OutputSettings& output = session_.shot().output;
    DisplayImage display = to_display(image, output.view, static_cast<float>(output.exposure));
    scenes_.draw_legend(display);
    if (output.burn_in) burn_in(display, words);
    return encode_png(display);
  }

  Session& session_;
  const SceneStage& scenes_;
  Outputs& outputs_;
  double saved_seconds_ = 0;
  std::unique_ptr<PathTracer> tracer_;  ///< made when the first picture has to be traced
};

}  // namespace

int run_turntable(const ShotOptions& options, int count) {
  Session session(options);
  const Shot& shot = session.shot();
  require_any_picture(shot);
  const int frame = session.frames().first;
  if (session.frames().count() > 1 && !options.frames.empty())
    session.console().warn(fmt::format("--turntable turns round one frame: {} is taken.", frame));
  ShotRun run(shot, session.context());
  Outputs outputs(shot.output.directory, shot.settings.name + ".turntable", session.context().log);
  const bool has_movie = shot.output.movie && shot.output.png && count > 1;
  if (has_movie) require_movie_path(outputs);
  session.prepare(outputs, run);
  SceneStage scenes(run);
  Scene scene = scenes.at(frame, run.skin(frame, moment_of(shot.render)));
  scene.next_camera.reset();  // nothing moves
  scene.camera_motion.clear();
  const Camera start = scene.camera;
  const auto turn = [&](int picture) { scene.camera = turned(start, static_cast<double>(picture - 1) / count); };
  std::vector<StageKey> contents;
  for (int picture = 1; picture <= count; ++picture) {
    turn(picture);
    contents.push_back(scenes.content_key(frame, scene));
  }
  Turntable turntable(session, scenes, outputs);
  turntable.remove_outdated(contents);
  int traced = 0;
  session.console().begin("pictures", count);
  for (int picture = 1; picture <= count; ++picture) {
    turn(picture);
    traced += turntable.make(picture, count, scene, contents[static_cast<std::size_t>(picture - 1)]) ? 1 : 0;
    session.console().advance(picture, fmt::format("picture {}", picture));
  }
  RunReport report = session.report("turntable", run);
  report.pictures.traced = traced;
  report.pictures.kept = count - traced;
  report.pictures.saved_seconds = turntable.saved_seconds();
  for (const auto& [extension, wanted] : {std::pair("png", shot.output.png), std::pair("exr", shot.output.exr)})
    if (wanted) report.made.push_back(outputs.frame_path(1, extension) + " .. " + outputs.frame_path(count, extension));
  if (shot.output.movie && !shot.output.png) session.context().log.info(kNoMovieWithoutPngs);
  if (has_movie) report.made.push_back(make_movie(shot, 1, count, outputs, session.context()));
  session.finish(report);
  return 0;
}

}  // namespace softreel
