#include <chrono>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/timer.h"
#include "tool/bodies/shot_inputs.h"
#include "tool/commands/commands.h"
#include "tool/export/body_samples.h"
#include "tool/export/export_look.h"
#include "tool/export/export_series.h"

namespace softreel {
namespace {

/// One series a body, or one for all, of each format.
std::vector<ExportSeries> make_series(const std::vector<const ExportFormat*>& formats, const ExportSettings& settings,
                                      const ExportFrames& frames, ShotRun& run, Outputs& outputs) {
  std::vector<std::size_t> all(run.body_count());
  for (std::size_t b = 0; b < all.size(); ++b) all[b] = b;
  std::vector<ExportSeries> series;
  for (const ExportFormat* format : formats) {
    if (format->file_per == FilePer::Shot)
      series.emplace_back(*format, settings, frames, all, run, outputs);
    else
      for (const std::size_t b : all)
        series.emplace_back(*format, settings, frames, std::vector<std::size_t>{b}, run, outputs);
  }
  return series;
}

void remove_outdated(std::vector<ExportSeries>& series, const Log& log) {
  int removed = 0;
  for (ExportSeries& one : series) removed += one.remove_outdated();
  if (removed > 0) log.info(fmt::format("{} outdated files removed", removed));
}

/// What lies beside these files and is not of the same state would be taken for one series with them.
void warn_of_leftovers(std::vector<ExportSeries>& series, std::vector<ExportSeries>& whole, const Log& log) {
  std::vector<std::string> leftovers;
  for (std::size_t i = 0; i < series.size(); ++i)
    for (std::string& path : series[i].leftovers(whole[i])) leftovers.push_back(std::move(path));
  if (leftovers.empty()) return;
  log.warn(fmt::format(
      "{}: {} of an older state of the shot or of other sub-frames beside those exported now. Export all "
      "frames, or remove what you do not want.",
      leftovers.front(),
      leftovers.size() == 1 ? "this file is" : fmt::format("this and {} more files are", leftovers.size() - 1)));
}

void warn_of_lost_looks(const std::vector<const ExportFormat*>& formats, const Shot& shot, const Log& log) {
  std::set<std::string> worn;
  for (const BodySettings& body : shot.bodies) worn.insert(body.material);
  for (const ExportFormat* format : formats)
    for (const std::string& name : worn) {
      const std::string lost = format->needs_look ? lost_look(format->name, name, shot.materials.at(name)) : "";
      if (!lost.empty()) log.warn(lost);
    }
}

/// Takes the samples of a body, frame by frame, to the series that want them.
class BodyExport {
 public:
  BodyExport(std::size_t body, const ExportSettings& settings, const ExportFrames& frames, ShotRun& run,
             std::vector<ExportSeries>& series)
      : body_(body), settings_(settings), frames_(frames), run_(run) {
    for (ExportSeries& one : series)
      if (one.has(body)) series_.push_back({&one, {}});
  }

  /// Asked once a frame and series, before `write`.
  void look_up(int frame) {
    for (Taker& taker : series_) taker.wanted.clear();
    for (int sample = first_sample(frame); sample <= last_sample(frame); ++sample)
      for (Taker& taker : series_) taker.wanted.push_back(taker.series->wants(sample));
  }

  /// The frame's sample, and those between it and the frame before.
  void write(int frame) {
    bool any = false, tets = false;
    for (const Taker& taker : series_)
      for (const bool wanted : taker.wanted) {
        any = any || wanted;
        tets = tets || (wanted && taker.series->format().needs_tets);
      }
    if (!any) return;
    const int between = last_sample(frame) - first_sample(frame);
    SkinRequest request{settings_.normals, 0, 1};
    request.nodes = tets;
    request.shutter = static_cast<double>(between) / (between + 1);
    request.segments = std::max(between, 1);
    int place = 0;
    run_.skin_times(body_, frame, request, [&](const SkinnedBody::Time& time) {
      const ScopedStage stage(run_.context().times, "export");
      if (tets && materials_.empty()) find_materials();
      write_sample(first_sample(frame) + place, place, time);
      ++place;
    });
    CHECK(place == between + 1);
  }

 private:
  struct Taker {
    ExportSeries* series;
    std::vector<bool> wanted;  ///< per sample of the frame
  };

  int last_sample(int frame) const { return (frame - frames_.first) * (settings_.subframes + 1); }
  int first_sample(int frame) const { return frame == frames_.first ? 0 : last_sample(frame) - settings_.subframes; }

  void find_materials() {
    materials_ =
        element_materials(run_.resolved(body_), run_.settings(body_), run_.loaded(body_), run_.filled(body_)->mesh);
  }

  void write_sample(int sample, int place, const SkinnedBody::Time& time) {
    const auto start = std::chrono::steady_clock::now();
    const LoadedBody& loaded = run_.loaded(body_);
    const std::vector<Vec3> positions = export_positions(settings_, loaded, time.positions);
    const std::vector<Vec3> normals = export_normals(settings_, loaded, time.normals);
    std::optional<TetSample> tets;
    if (!time.nodes.empty())
      tets.emplace(TetSample{*run_.filled(body_), materials_, time.nodes, run_.resolved(body_).solver.dilatation});
    double shared = seconds_since(start);
    for (Taker& taker : series_) {
      if (!taker.wanted[static_cast<std::size_t>(place)]) continue;
      const double frame = sample_times(settings_, frames_).frame(sample);
      taker.series->append(sample, {body_, frame, positions, normals, tets ? &*tets : nullptr}, shared);
      shared = 0;
    }
  }

  std::size_t body_;
  const ExportSettings& settings_;
  ExportFrames frames_;
  ShotRun& run_;
  std::vector<Taker> series_;
  std::vector<ElementMaterial> materials_;  ///< per tetrahedron; empty until a format needs them
};

PlannedWork planned(std::vector<ExportSeries> series, const std::string& folder) {
  PlannedWork work;
  for (ExportSeries& one : series) {
    one.require_free_paths();
    const SeriesPlan plan = one.plan();
    work.frames.insert(work.frames.end(), plan.frames.begin(), plan.frames.end());
    work.missing += plan.missing;
    work.of += plan.of;
    *work.outdated += plan.outdated;
    work.lines.push_back(
        fmt::format("export {} of {} {} files: {}", plan.missing, plan.of, one.format().name, one.made_line()));
  }
  if (*work.outdated > 0) work.lines.push_back(fmt::format("replace {} outdated files in {}", *work.outdated, folder));
  return work;
}

}  // namespace

int run_export(const ExportOptions& options) {
  const std::vector<const ExportFormat*> formats = chosen_formats(options.wishes);
  ExportSettings settings = export_settings(options.wishes, formats);
  if (options.shot.dry_run)
    return run_plan(options.shot, [&](ShotRun& run, Outputs& outputs) {
      if (!options.wishes.fps) settings.fps = run.shot().settings.fps;
      outputs.protect(files_read(run.shot()));
      const FrameSpan span = parse_frames(options.shot.frames, run.shot());
      return planned(make_series(formats, settings, {span.first, span.last}, run, outputs), outputs.folder());
    });
  Session session(options.shot);
  const Shot& shot = session.shot();
  if (!options.wishes.fps) settings.fps = shot.settings.fps;
  const ExportFrames frames{session.frames().first, session.frames().last};
  Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
  ShotRun run(shot, session.context());
  session.prepare(outputs, run);
  outputs.note_simulation();
  std::vector<ExportSeries> series = make_series(formats, settings, frames, run, outputs);
  for (const ExportSeries& one : series) one.require_free_paths();
  remove_outdated(series, session.context().log);
  warn_of_lost_looks(formats, shot, session.context().log);
  std::vector<BodyExport> bodies;
  for (std::size_t b = 0; b < run.body_count(); ++b) bodies.emplace_back(b, settings, frames, run, series);
  session.console().begin("frames", session.frames().count());
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    session.context().stop_if_cancelled();
    for (BodyExport& body : bodies) {
      body.look_up(frame);
      body.write(frame);
    }
    session.console().advance(frame - frames.first + 1, fmt::format("frame {}", frame));
    session.keep_within_limit();
  }
  for (ExportSeries& one : series) one.finish();
  const ExportFrames all_frames{shot.settings.first_frame, shot.settings.last_frame};
  std::vector<ExportSeries> whole = make_series(formats, settings, all_frames, run, outputs);
  warn_of_leftovers(series, whole, session.context().log);
  RunReport report = session.report("export", run);
  for (const ExportSeries& one : series) {
    report.made.push_back(one.made_line());
    report.files_written += one.counts().written;
    report.files_kept += one.counts().kept;
    report.files_saved_seconds += one.counts().saved_seconds;
  }
  session.finish(report);
  return 0;
}

}  // namespace softreel
