#include <cmath>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "core/base/error.h"
#include "render/image/flip.h"
#include "render/image/image_compare.h"
#include "render/pathtrace/path_tracer.h"
#include "tool/cache/atomic_file.h"
#include "tool/commands/commands.h"
#include "tool/outputs/outputs.h"
#include "tool/report/golden_page.h"
#include "tool/stages/golden_record.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {
namespace fs = std::filesystem;
namespace {

std::set<int> golden_frames(const Shot& shot) {
  const ShotSettings& settings = shot.settings;
  if (shot.golden.frames.empty())
    return {settings.first_frame, (settings.first_frame + settings.last_frame) / 2, settings.last_frame};
  for (const int frame : shot.golden.frames)
    if (frame < settings.first_frame || frame > settings.last_frame)
      throw input_error(
          fmt::format("{}: golden.frames has {}, which is no frame of the shot.\n  Accepted: {} to {}. Change "
                      "it, or shot.frames.",
                      shot.path, frame, settings.first_frame, settings.last_frame));
  return {shot.golden.frames.begin(), shot.golden.frames.end()};
}

/// The shot as it is compared: small and coarse enough to be rendered after every change.
Shot at_test_quality(Shot shot) {
  RenderParams& params = shot.render.params;
  if (params.width > shot.golden.max_width) {
    params.height =
        std::max(1L, std::lround(static_cast<double>(params.height) * shot.golden.max_width / params.width));
    params.width = shot.golden.max_width;
  }
  params.samples = std::min(params.samples, shot.golden.max_samples);
  params.window = window_of(shot.render);
  params.time_limit = 0;  // bits would depend on the machine
  params.auxiliary = false;
  params.channels = {};
  return shot;
}

/// One shot's golden images.
class GoldenShot {
 public:
  GoldenShot(const GoldenOptions& options, const std::string& path)
      : options_(options),
        session_(with_path(options.shot, path)),
        shot_(at_test_quality(session_.shot())),
        outputs_(shot_.output.directory, shot_.settings.name, session_.context().log),
        folder_(options.reference.empty() ? fs::path(shot_.path).parent_path() / "golden"
                                          : fs::path(options.reference)),
        run_(shot_, session_.context()),
        scenes_(run_),
        tracer_(session_.context().threads, session_.context().times),
        settings_(golden_settings(run_)) {
    if (!options.update) record_ = read_golden_record(record_path());
  }

  /// Compares or updates all frames; adds them to `frames`.
  void run(std::vector<GoldenPageFrame>& frames) {
    const std::set<int> wanted = golden_frames(shot_);
    int done = 0;
    GoldenRecord now{settings_, {}};
    session_.console().begin("golden frames", static_cast<int>(wanted.size()));
    for (const int frame : wanted) {
      frames.push_back(take(frame, now));
      missing_ += frames.back().missing ? 1 : 0;
      session_.console().advance(++done, fmt::format("frame {}", frame));
    }
    if (options_.update) keep(record_path(), to_json(now));
    traced_ = done;
    // Of several shots each says it where it comes, of one the message that ends the program.
    if (missing_ == done && options_.shots.size() > 1) session_.console().warn(missing_words());
  }

  /// What is said once, not frame by frame, where there is no golden image at all: as a rule on the first run. Empty
  /// where there is one.
  std::string missing_words() const {
    if (missing_ == 0 || !has_none()) return "";
    return fmt::format("{}: no golden images yet in {}; --update makes them", shot_.path,
                       folder_.empty() ? "." : folder_.string());
  }

  void finish(const std::string& page) {
    RunReport report = session_.report("golden", run_);
    report.pictures.traced = traced_;
    report.made = made_;
    if (!page.empty()) report.made.push_back(page);
    session_.finish(report);
  }

  const std::string& output_folder() const { return outputs_.folder(); }

 private:
  static ShotOptions with_path(ShotOptions options, const std::string& path) {
    options.shot = path;
    return options;
  }
  std::string record_path() const { return (folder_ / (shot_.settings.name + ".golden.json")).string(); }
  std::string golden_path(int frame) const {
    return (folder_ / fmt::format("{}.{:04}.png", shot_.settings.name, frame)).string();
  }
  template <typename Content>
  void keep(const std::string& path, const Content& content) {
    write_file(path, content);
    made_.push_back(path);
  }

  GoldenPageFrame take(int frame, GoldenRecord& now) {
    const std::vector<SkinnedBody> bodies = run_.skin(frame, skin_request(shot_.render));
    now.frames[frame] = golden_geometry(run_, bodies);
    const Image image =
        tracer_.render(scenes_.at(frame, bodies), shot_.render.params, [] { return cancellation().load(); });
    const DisplayImage picture =
        over_grey(to_display(image, shot_.output.view, static_cast<float>(shot_.output.exposure)));
    GoldenPageFrame result{shot_.settings.name, frame, false, false, {}, {}, {}, {}, {}};
    if (options_.update) {
      keep(golden_path(frame), encode_png(picture));
      return result;
    }
    judge(picture, result);
    const GoldenCause cause = find_cause(record_, frame, settings_, now.frames[frame]);
    if (result.changed || (record_ && !cause.same_geometry)) result.cause = cause.words;
    const std::string line = fmt::format("{}: {}", golden_path(frame), result.verdict);
    const std::string actual = outputs_.frame_path(frame, "actual.png");
    if (result.changed && !(result.missing && has_none()))
      session_.console().warn(line +
                              (result.golden.empty() ? "" : "\n  see " + actual + " and the difference beside it") +
                              (result.cause.empty() ? "" : "\n  " + result.cause));
    else if (!result.changed && !result.cause.empty())
      session_.console().info(line + "; but " + result.cause);
    return result;
  }

  /// Of no frame is there a golden image.
  bool has_none() const {
    const std::set<int> wanted = golden_frames(shot_);
    return std::none_of(wanted.begin(), wanted.end(), [&](int frame) { return fs::exists(golden_path(frame)); });
  }

  /// Compares a picture with its golden image; leaves both and their difference in the output folder if it changed.
  void judge(const DisplayImage& picture, GoldenPageFrame& result) {
    const std::string path = golden_path(result.frame), actual = outputs_.frame_path(result.frame, "actual.png");
    if (!fs::exists(path)) {
      result.changed = result.missing = true;
      result.verdict = "there is no golden image. Look at the frame, then make one with --update.";
      result.now = encode_png(picture);
      return;
    }
    const DisplayImage golden = read_png(path);
    const ImageDifference difference = compare(picture, golden);
    if (difference.identical) {
      result.verdict = "equal bits";
      return;
    }
    result.now = encode_png(picture);
    if (!difference.same_size) {
      result.changed = true;
      result.verdict = fmt::format("has {} x {} pixels, the frame has {} x {}", golden.width, golden.height,
                                   picture.width, picture.height);
      write_file(actual, result.now);
      return;
    }
    const FlipMap map = flip(golden, picture);
    const FlipSummary summary = summarize(map);
    const double threshold = shot_.golden.threshold;
    result.changed = summary.worst_block > threshold;
    result.verdict =
        fmt::format("{}: largest FLIP error of a {} x {} block {:.4f} (accepted: {}), at pixel ({}, {}); mean {:.5f}",
                    result.changed ? "changed" : "other bits, the same to the eye", kFlipBlock, kFlipBlock,
                    summary.worst_block, threshold, summary.worst_x, summary.worst_y, summary.mean);
    if (!result.changed) return;
    result.golden = encode_png(golden);
    result.difference = encode_png(flip_picture(map));
    write_file(actual, result.now);
    write_file(outputs_.frame_path(result.frame, "difference.png"), result.difference);
  }

  const GoldenOptions& options_;
  Session session_;
  Shot shot_;
  Outputs outputs_;
  fs::path folder_;
  ShotRun run_;
  SceneStage scenes_;
  PathTracer tracer_;
  SettingsSnapshot settings_;
  std::optional<GoldenRecord> record_;
  std::vector<std::string> made_;
  int traced_ = 0, missing_ = 0;
};

/// One shot of several: what is wrong with it is said, and the others go on.
bool fails(const GoldenOptions& options, const std::string& path, const std::function<void()>& work) {
  try {
    work();
    return false;
  } catch (const Error& error) {
    if (options.shots.size() == 1 || error.kind() == ErrorKind::Interrupt) throw;
    Console(Verbosity::Quiet, false).warn(fmt::format("{}: {}", path, error.what()));
    return true;
  }
}

}  // namespace

int run_golden(const GoldenOptions& options) {
  std::vector<GoldenPageFrame> frames;
  std::string page_path, missing;
  int failed = 0;
  for (const std::string& path : options.shots) {
    const bool has_failed = fails(options, path, [&] {
      if (options.shot.dry_run) {
        ShotOptions one = options.shot;
        one.shot = path;
        run_plan(one);
        return;
      }
      GoldenShot shot(options, path);
      if (page_path.empty()) page_path = (fs::path(shot.output_folder()) / "golden.html").string();
      shot.run(frames);
      missing = shot.missing_words();
      if (!options.update) write_file(page_path, golden_page(frames));
      shot.finish(options.update ? "" : page_path);
    });
    failed += has_failed ? 1 : 0;
  }
  const auto changed = std::count_if(frames.begin(), frames.end(), [](const auto& frame) { return frame.changed; });
  if (!missing.empty() && options.shots.size() == 1)
    throw work_error(fmt::format("{}. The frames are in {}", missing, page_path));
  if (failed > 0)
    throw work_error(fmt::format("{} of {} shots failed; of the others {} of {} golden images changed.", failed,
                                 options.shots.size(), changed, frames.size()));
  if (changed > 0)
    throw work_error(fmt::format("{} of {} golden images changed; see {}", changed, frames.size(), page_path));
  return 0;
}

}  // namespace softreel
