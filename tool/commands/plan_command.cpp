#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tool/commands/commands.h"
#include "tool/commands/plan_estimate.h"
#include "tool/stages/json_text.h"
#include "tool/stages/movie_stage.h"
#include "tool/stages/picture_stage.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"
#include "tool/stages/simulate_key.h"
#include "tool/stages/stage_names.h"

namespace softreel {
namespace {

/// Measured on 2 cores at 2.6 GHz with the shots of presets/ (README, "How fast"); a plan is right within a factor of
/// two or so there, and scales with the machine elsewhere.
constexpr double kStepSecondsPerTet = 4e-6;    ///< one dynamic step, two threads
constexpr double kStaticStepsPerFrame = 25;    ///< a static frame costs about this many steps
constexpr double kFillSecondsPerTet = 1.5e-5;  ///< distance, lattice, embedding
constexpr double kPathsPerSecond = 2e6;        ///< two threads
constexpr double kBytesPerTet = 1200;          ///< matrix, hierarchy, state
constexpr double kBytesPerTriangle = 700;      ///< surface, normals, trees
constexpr double kBytesPerPixel = 48;
constexpr double kBytesOfProgram = 2.5e7;  ///< code and libraries
/// Of graded bodies, per square of the wanted distance on the sides of the body's box.
constexpr double kTetsPerSquaredError = 0.3;

struct Plan {
  double tets = 0, triangles = 0;
  int simulated = 0, traced = 0;  ///< body frames and pictures that are not stored
  int kept = 0;                   ///< pictures that lie in the output folder already
  bool complete = false;          ///< nothing is to be done
  double fill_seconds = 0, simulate_seconds = 0, render_seconds = 0, bytes = 0;
};

/// Tetrahedra that a body will have: as given or asked for, or from the volume of its box where the edge is given (an
/// upper bound: 12 in each cell of the lattice).
double expected_tets(const BodySettings& body, const LoadedBody& loaded) {
  if (loaded.given) return static_cast<double>(loaded.given->tets.size());
  if (body.tets > 0) return static_cast<double>(body.tets);
  const Vec3 size = used_bounds(loaded.surface).size();
  if (body.error.value > 0) {
    const double area = 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
    return kTetsPerSquaredError * area / std::pow(body.error.in_meters(size.norm()), 2);
  }
  return 12 * size.prod() / (body.edge * body.edge * body.edge);
}

/// Body frames that the pictures `needed` ask for and the cache does not hold: all from the last stored one on.
int frames_to_simulate(const ShotRun& run, std::size_t body, const std::vector<int>& needed) {
  const int start = first_simulated_frame(run.shot());
  std::set<int> missing;
  for (const int frame : needed)
    for (int f = frame; f >= start; --f) {
      if (missing.count(f) > 0 || run.context().cache.has(kSimulationStage, run.simulation(body).frame_key(f))) break;
      missing.insert(f);
    }
  return static_cast<int>(missing.size());
}

Plan make_plan(const ShotRun& run, const PictureStage& pictures, const FrameSpan& frames, int threads) {
  const Shot& shot = run.shot();
  const double speed = threads / 2.0;
  std::vector<int> needed;
  Plan plan;
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    if (pictures.is_kept(frame))
      plan.kept += 1;
    else if (!pictures.is_stored(frame))
      needed.push_back(frame);
  }
  plan.traced = static_cast<int>(needed.size());
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const LoadedBody& loaded = run.loaded(b);
    const double tets = expected_tets(run.settings(b), loaded);
    const double steps =
        shot.settings.mode == SimulationMode::Static ? kStaticStepsPerFrame : run.resolved(b).solver.substeps;
    const int simulated = frames_to_simulate(run, b, needed);
    plan.tets += tets;
    plan.triangles += static_cast<double>(loaded.surface.triangles.size());
    plan.simulated += simulated;
    plan.simulate_seconds += simulated * steps * tets * kStepSecondsPerTet / speed;
    if (plan.traced > 0 && !run.context().cache.has(kTetrahedraStage, run.simulation(b).filled_key()))
      plan.fill_seconds += tets * kFillSecondsPerTet / speed;
  }
  const double pixels = static_cast<double>(shot.render.params.width) * shot.render.params.height;
  plan.render_seconds = plan.traced * pixels * shot.render.params.samples / (kPathsPerSecond * speed);
  plan.bytes =
      kBytesOfProgram + plan.tets * kBytesPerTet + plan.triangles * kBytesPerTriangle + pixels * kBytesPerPixel;
  return plan;
}

/// Whether movie and contact sheet are there as far as the shot wants them, and the report.
bool has_the_rest(const Session& session, const Outputs& outputs) {
  const Shot& shot = session.shot();
  const FrameSpan& frames = session.frames();
  const bool whole = frames.first == shot.settings.first_frame && frames.last == shot.settings.last_frame;
  if (shot.output.movie && shot.output.png && whole && frames.count() > 1 &&
      !is_movie_done(shot, frames.first, frames.last, outputs))
    return false;
  const SheetOptions sheet;
  if (shot.output.contact_sheet && shot.output.png &&
      !is_sheet_done(shot, sheet_frames(frames.first, frames.last, sheet.count), sheet.columns, outputs))
    return false;
  std::error_code none;
  return std::filesystem::is_regular_file(outputs.path("report.json"), none);
}

void print_json(const Session& session, const Plan& plan, std::size_t bodies) {
  const Shot& shot = session.shot();
  const FrameSpan& frames = session.frames();
  const int body_frames = static_cast<int>(bodies) * (frames.last - first_simulated_frame(shot) + 1);
  const nlohmann::ordered_json json{{"command", "plan"},
                                    {"shot", shot.path},
                                    {"name", shot.settings.name},
                                    {"output", shot.output.directory},
                                    {"frames", {frames.first, frames.last}},
                                    {"complete", plan.complete},
                                    {"tetrahedra", plan.tets},
                                    {"triangles", plan.triangles},
                                    {"simulate", {{"missing", plan.simulated}, {"of", body_frames}}},
                                    {"trace", {{"missing", plan.traced}, {"there", plan.kept}, {"of", frames.count()}}},
                                    {"expected",
                                     {{"bytes", plan.bytes},
                                      {"seconds", plan.fill_seconds + plan.simulate_seconds + plan.render_seconds},
                                      {"fill_seconds", plan.fill_seconds},
                                      {"simulate_seconds", plan.simulate_seconds},
                                      {"render_seconds", plan.render_seconds}}}};
  std::printf("%s\n", json_text(json).c_str());
}

}  // namespace

int run_plan(const ShotOptions& options) {
  ShotOptions silent = options;
  silent.quiet = true;
  const Session session(silent);
  const Shot& shot = session.shot();
  const FrameSpan frames = session.frames();
  ShotRun run(shot, session.context(), DialUse::LookUp);
  const SceneStage scenes(run);
  Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
  const PictureStage pictures(scenes, shot, outputs, session.context());
  Plan plan = make_plan(run, pictures, frames, session.context().threads.count());
  plan.complete = plan.kept == frames.count() && has_the_rest(session, outputs);
  if (options.json) {
    print_json(session, plan, run.body_count());
    return 0;
  }
  std::printf("%s: would do (nothing is written):\n", shot.settings.name.c_str());
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    if (shot.dial.is_on())
      std::printf("  %s: %s\n", shot.bodies[b].name.c_str(),
                  run.dial(b) ? describe(*run.dial(b), shot).c_str()
                              : "turn the error dial by short coarse runs; what follows is of default sizes");
    const bool cached = session.context().cache.has(kTetrahedraStage, run.simulation(b).filled_key());
    std::printf("  fill %s: %zu triangles, about %.0f tetrahedra%s\n", shot.bodies[b].name.c_str(),
                run.loaded(b).surface.triangles.size(), expected_tets(run.settings(b), run.loaded(b)),
                cached ? " (in the cache already)" : "");
  }
  std::printf(
      "  simulate %d of %zu body frames (%s), the others are stored or not needed\n", plan.simulated,
      run.body_count() * static_cast<std::size_t>(frames.last - first_simulated_frame(shot) + 1),
      shot.settings.mode == SimulationMode::Static
          ? "static"
          : fmt::format("{} sub-steps{}", run.resolved(0).solver.substeps, shot.solver.step_error > 0 ? " or more" : "")
                .c_str());
  std::printf("  trace %d of %d frames of %d x %d at %d samples to %s\n", plan.traced, frames.count(),
              shot.render.params.width, shot.render.params.height, shot.render.params.samples,
              shot.output.directory.c_str());
  std::printf("  expected, within a factor of two: memory %s; time %s (fill %s, simulate %s, render %s)\n",
              format_bytes(plan.bytes).c_str(),
              format_duration(plan.fill_seconds + plan.simulate_seconds + plan.render_seconds).c_str(),
              format_duration(plan.fill_seconds).c_str(), format_duration(plan.simulate_seconds).c_str(),
              format_duration(plan.render_seconds).c_str());
  return 0;
}

PlanEstimate estimate_plan(const ShotRun& run, const PictureStage& pictures, const FrameSpan& frames, int threads) {
  const Plan plan = make_plan(run, pictures, frames, threads);
  return {plan.bytes, plan.fill_seconds, plan.simulate_seconds, plan.render_seconds, plan.traced};
}

}  // namespace softreel
