// A turntable: the shot at one frame, with the camera on a circle round what it looks at.
#include <chrono>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/base/timer.h"
#include "tool/commands/commands.h"
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
  camera.position = camera.target + Eigen::AngleAxisf(angle, Vec3f::UnitY()) * (camera.position - camera.target);
  return camera;
}

StageKey file_key(const char* extension, const StageKey& content, const Shot& shot, const BurnIn& words) {
  KeyHasher key(fmt::format("turntable {} 2", extension));
  key.add(content).add(shot.output.view).add(shot.output.exposure).add(shot.output.burn_in);
  if (shot.output.burn_in) key.add(words.left).add(words.right);
  return key.key();
}

/// The pictures of one turntable on their way to files.
class Turntable {
 public:
  Turntable(Session& session, const SceneStage& scenes, Outputs& outputs)
      : session_(session), scenes_(scenes), outputs_(outputs) {}

  /// Writes the files of a picture unless they are there. True if it was traced.
  bool make(int picture, int count, const Scene& scene, const StageKey& content) {
    const Shot& shot = session_.shot();
    const BurnIn words{shot.settings.name, fmt::format("{} / {}", picture, count)};
    const StageKey png = file_key("png", content, shot, words), exr = file_key("exr", content, shot, words);
    const std::string png_path = outputs_.frame_path(picture, "png"), exr_path = outputs_.frame_path(picture, "exr");
    if ((!shot.output.png || outputs_.is_done(png_path, png)) && (!shot.output.exr || outputs_.is_done(exr_path, exr)))
      return false;
    const auto start = std::chrono::steady_clock::now();
    if (!tracer_) tracer_ = std::make_unique<PathTracer>(session_.context().threads, session_.context().times);
    const Image image = tracer_->render(scene, shot.render.params, [] { return cancellation().load(); });
    const double seconds = seconds_since(start);
    if (shot.output.exr) outputs_.write(exr_path, exr, encode_exr(image), seconds);
    if (!shot.output.png) return true;
    DisplayImage display = to_display(image, shot.output.view, static_cast<float>(shot.output.exposure));
    scenes_.draw_legend(display);
    if (shot.output.burn_in) burn_in(display, words);
    outputs_.write(png_path, png, encode_png(display), seconds);
    return true;
  }

 private:
  Session& session_;
  const SceneStage& scenes_;
  Outputs& outputs_;
  std::unique_ptr<PathTracer> tracer_;  ///< made when the first picture has to be traced
};

}  // namespace

int run_turntable(const ShotOptions& options, int count) {
  Session session(options);
  const Shot& shot = session.shot();
  const int frame = session.frames().first;
  if (session.frames().count() > 1 && !options.frames.empty())
    session.console().warn(fmt::format("--turntable turns round one frame: {} is taken.", frame));
  ShotRun run(shot, session.context());
  Outputs outputs(shot.output.directory, shot.settings.name + ".turntable", session.context().log);
  session.prepare(outputs, run);
  SceneStage scenes(run);
  Scene scene = scenes.at(frame, run.skin(frame, moment_of(shot.render)));
  scene.next_camera.reset();  // nothing moves
  scene.camera_motion.clear();
  const Camera start = scene.camera;
  Turntable turntable(session, scenes, outputs);
  int traced = 0;
  session.console().begin("pictures", count);
  for (int picture = 1; picture <= count; ++picture) {
    scene.camera = turned(start, static_cast<double>(picture - 1) / count);
    traced += turntable.make(picture, count, scene, scenes.content_key(frame, scene)) ? 1 : 0;
    session.console().advance(picture, fmt::format("picture {}", picture));
  }
  RunReport report = session.report("turntable", run);
  report.pictures.traced = traced;
  report.pictures.kept = count - traced;
  for (const auto& [extension, wanted] : {std::pair("png", shot.output.png), std::pair("exr", shot.output.exr)})
    if (wanted) report.made.push_back(outputs.frame_path(1, extension) + " .. " + outputs.frame_path(count, extension));
  if (shot.output.movie && shot.output.png && count > 1)
    report.made.push_back(make_movie(shot, 1, count, outputs, session.context()));
  session.finish(report);
  return 0;
}

}  // namespace softreel
