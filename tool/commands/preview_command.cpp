#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/timer.h"
#include "render/image/burn_in.h"
#include "render/preview/preview.h"
#include "render/preview/preview_lights.h"
#include "tool/bodies/simulate_key.h"
#include "tool/commands/commands.h"
#include "tool/commands/preview_cut.h"
#include "tool/outputs/outputs.h"
#include "tool/stages/gizmos.h"
#include "tool/stages/movie_stage.h"
#include "tool/stages/picture_stage.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {

namespace {

GizmoKinds gizmo_kinds(const std::vector<std::string>& names) {
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  if (has("none") && names.size() > 1)
    throw input_error(
        "--gizmos: none stands beside other kinds.\n  Accepted: none alone, all, or a list of pins, pulls, regions.");
  return {has("all") || has("pins"), has("all") || has("pulls"), has("all") || has("regions")};
}

bool shows_tets(const PreviewOptions& options) {
  return options.kind == "tets" || !options.cut.empty();
}

void check_cut_options(const PreviewOptions& options) {
  check_cut(options.cut);
  if (options.kind == "surface" && !options.cut.empty())
    throw input_error(
        fmt::format("--cut {}: a surface has no inside to show.\n  Accepted: --cut with --kind tets. Leave out --kind "
                    "surface or --cut.",
                    options.cut));
}

/// The frames of one playblast on their way to files.
class Playblast {
 public:
  Playblast(Session& session, ShotRun& run, Outputs& outputs, const PreviewOptions& options)
      : session_(session),
        run_(run),
        outputs_(outputs),
        scenes_(run),
        gizmos_(run, gizmo_kinds(options.gizmos)),
        fast_(options.mode == "fast"),
        wireframe_(options.wireframe) {
    if (shows_tets(options)) cut_.emplace(run, scenes_, options.cut);
  }

  /// Nothing of an older shot or other options stays under the names of these frames, nor their movie: a killed run
  /// leaves no mixture.
  void remove_outdated(const FrameSpan& frames) {
    const int removed = outputs_.remove_outdated(keys(frames));
    if (removed > 0) session_.console().info(fmt::format("{} outdated pictures removed", removed));
    const ShotSettings& all = run_.shot().settings;
    const std::string movie = outputs_.path("mp4");
    const int movies = outputs_.remove_if({movie}, [&](const std::string&) {
      return is_movie_outdated(run_.shot(), all.first_frame, all.last_frame, outputs_);
    });
    if (movies > 0) session_.console().info(fmt::format("{} removed: it is of other pictures", movie));
  }

  /// Frames that are not made now, and whose pictures are of an older state of the shot or of other options.
  void warn_of_leftovers() const {
    const ShotSettings& all = run_.shot().settings;
    std::vector<std::string> leftovers;
    for (const auto& [path, key] : keys({all.first_frame, all.last_frame}))
      if (outputs_.claimed_state(path, key) == OutputState::Stale) leftovers.push_back(path);
    if (leftovers.empty()) return;
    session_.console().warn(
        fmt::format("{}: {} of an older state of the shot or of other options beside those drawn now. Draw all frames, "
                    "or remove what you do not want.",
                    leftovers.front(),
                    leftovers.size() == 1 ? "this picture is"
                                          : fmt::format("this and {} more pictures are", leftovers.size() - 1)));
  }

  /// Writes the picture of a frame unless it is there. True if it was drawn.
  bool make(int frame) {
    const std::string path = outputs_.frame_path(frame, "png");
    const StageKey key = file_key(frame);
    if (outputs_.is_done(path, key)) {
      if (const auto entry = outputs_.entry(path)) saved_seconds_ += entry->seconds;
      return false;
    }
    if (!preview_) {
      preview_ = make_egl_preview();
      session_.console().info("preview on " + preview_->description());
    }
    SkinRequest request = still_request(run_.shot().render);
    request.nodes = cut_.has_value();
    const std::vector<SkinnedBody> bodies = run_.skin(frame, request);
    Scene scene = scenes_.at(frame, bodies);
    if (cut_) cut_->replace_bodies(frame, bodies, scene);
    warn_of_lights(scene);
    const auto start = std::chrono::steady_clock::now();
    const std::vector<std::vector<char>> shown = cut_ ? cut_->shown_points() : std::vector<std::vector<char>>{};
    const Bytes png = encode_png(draw(frame, scene, gizmos_.at(frame, bodies, shown)));
    outputs_.write(path, key, png, seconds_since(start));
    return true;
  }
  double saved_seconds() const { return saved_seconds_; }

 private:
  std::map<std::string, StageKey> keys(const FrameSpan& frames) const {
    std::map<std::string, StageKey> keys;  // by path
    for (int frame = frames.first; frame <= frames.last; ++frame)
      keys[outputs_.frame_path(frame, "png")] = file_key(frame);
    return keys;
  }
  StageKey file_key(int frame) const {
    const OutputSettings& output = run_.shot().output;
    KeyHasher key("preview 10");
    key.add(scenes_.preview_key(frame)).add(output.view).add(output.exposure).add(fast_).add(wireframe_);
    if (output.view == ViewTransform::Raw) key.add("linear");
    gizmos_.add_key(key, frame);
    if (cut_) cut_->add_key(key);
    if (output.burn_in) {
      const BurnIn words = frame_words(run_.shot().settings, frame);
      key.add(words.left).add(words.right);
    }
    return key.key();
  }
  /// Once: a shot has the same lights in all frames.
  void warn_of_lights(const Scene& scene) {
    const int left_out = std::exchange(knows_lights_, true) ? 0 : lights_left_out(scene);
    if (left_out == 0) return;
    session_.console().warn(fmt::format(
        "Previews have room for {} lamps and {} suns, the strongest: {} of the shot's {} lights {} left out. "
        "Pictures of render show all.",
        kMaxPreviewLamps, kMaxPreviewSuns, left_out, scene.area_lights.size() + scene.suns.size(),
        left_out == 1 ? "is" : "are"));
  }
  DisplayImage draw(int frame, const Scene& scene, GizmoMarks marks) {
    const Shot& shot = run_.shot();
    const ScopedStage stage(session_.context().times, "preview");
    DisplayImage picture = preview_->draw(scene, shot.render.params.width, shot.render.params.height, shot.output.view,
                                          static_cast<float>(shot.output.exposure),
                                          {fast_, wireframe_, std::move(marks), shot.render.params.window});
    picture.linear = shot.output.view == ViewTransform::Raw;
    scenes_.draw_legend(picture);
    if (shot.output.burn_in) burn_in(picture, frame_words(shot.settings, frame));
    return picture;
  }

  Session& session_;
  ShotRun& run_;
  Outputs& outputs_;
  SceneStage scenes_;
  Gizmos gizmos_;
  std::optional<PreviewCut> cut_;  ///< of the tetrahedra, where they are shown
  bool fast_, wireframe_;
  bool knows_lights_ = false;         ///< whether warn_of_lights was asked
  std::unique_ptr<Preview> preview_;  ///< made when the first frame has to be drawn
  double saved_seconds_ = 0;
};

/// Which of the files are of the shot as it is now, the drawing of each finds out.
PlannedWork planned(const Shot& shot, const FrameSpan& frames, const Outputs& outputs) {
  PlannedWork work;
  work.of = frames.count();
  work.outdated = std::nullopt;
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    work.frames.push_back(frame);
    work.missing += std::filesystem::exists(outputs.frame_path(frame, "png")) ? 0 : 1;
  }
  work.lines.push_back(fmt::format("draw {} frames of {} x {} to {}, {} of which are not there", work.of,
                                   shot.render.params.width, shot.render.params.height, outputs.folder(),
                                   work.missing));
  return work;
}

}  // namespace

int run_preview(const PreviewOptions& options) {
  check_cut_options(options);
  if (options.shot.dry_run)
    return run_plan(options.shot, [&](ShotRun& run, Outputs& of_pictures) {
      const Shot& shot = run.shot();
      const Outputs outputs(of_pictures.folder(), shot.settings.name + ".preview", run.context().log);
      return planned(shot, parse_frames(options.shot.frames, shot), outputs);
    });
  Session session(options.shot);
  const Shot& shot = session.shot();
  const FrameSpan frames = session.frames();
  Outputs outputs(shot.output.directory, shot.settings.name + ".preview", session.context().log);
  ShotRun run(shot, session.context());
  const bool has_movie = shot.output.movie && session.is_whole() && frames.count() > 1;
  if (has_movie) require_movie_path(outputs);
  session.prepare(outputs, run);
  Playblast playblast(session, run, outputs, options);
  playblast.remove_outdated(frames);
  int written = 0;
  session.console().begin("frames", frames.count());
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    session.context().stop_if_cancelled();
    const bool drawn = playblast.make(frame);
    written += drawn ? 1 : 0;
    session.console().advance(frame - frames.first + 1,
                              fmt::format("frame {}{}", frame, drawn ? "" : " there already"));
  }
  playblast.warn_of_leftovers();
  session.remove_pictures_outside(outputs);
  RunReport report = session.report("preview", run);
  report.files_written = written;
  report.files_kept = frames.count() - written;
  report.files_saved_seconds = playblast.saved_seconds();
  report.made.push_back(outputs.frame_path(frames.first, "png") + " .. " + outputs.frame_path(frames.last, "png"));
  if (has_movie) report.made.push_back(make_movie(shot, frames.first, frames.last, outputs, session.context()));
  session.finish(report);
  return 0;
}

}  // namespace softreel
