#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tool/bodies/glue_stage.h"
#include "tool/bodies/simulate_key.h"
#include "tool/cache/json_text.h"
#include "tool/cache/stage_names.h"
#include "tool/commands/commands.h"
#include "tool/commands/picture_wishes.h"
#include "tool/commands/plan_estimate.h"
#include "tool/stages/movie_stage.h"
#include "tool/stages/picture_stage.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"

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
/// Of textures, with their halvings, and of surroundings, with what their light is drawn by.
constexpr double kBytesPerTexel = 16;
/// ffmpeg, which holds some frames on their way.
constexpr double kEncoderBytes = 6e7, kEncoderBytesPerPixel = 200;
constexpr double kBytesOfProgram = 2.5e7;  ///< code and libraries
/// Of graded bodies, per square of the wanted distance on the sides of the body's box.
constexpr double kTetsPerSquaredError = 0.3;

struct Plan {
  double tets = 0, triangles = 0;
  int simulated = 0, traced = 0;  ///< body frames and pictures that are not stored; bodies that glue joins count once
  int simulated_of = 0;           ///< body frames in all
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

/// Indices of the bodies that are simulated as one: those that glue joins, and each of the others.
std::vector<std::vector<std::size_t>> simulated_wholes(const Shot& shot) {
  std::vector<std::vector<std::size_t>> wholes = glue_groups(shot);
  std::set<std::size_t> glued;
  for (const std::vector<std::size_t>& group : wholes) glued.insert(group.begin(), group.end());
  for (std::size_t b = 0; b < shot.bodies.size(); ++b)
    if (glued.count(b) == 0) wholes.push_back({b});
  return wholes;
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

/// Adds what the bodies need that are simulated as one.
void add_whole(const ShotRun& run, const std::vector<std::size_t>& bodies, const std::vector<int>& needed, double speed,
               Plan& plan) {
  double tets = 0;
  for (const std::size_t b : bodies) {
    const double own = expected_tets(run.settings(b), run.loaded(b));
    tets += own;
    plan.triangles += static_cast<double>(run.loaded(b).surface.triangles.size());
    if (!needed.empty() && !run.context().cache.has(kTetrahedraStage, run.simulation(b).filled_key()))
      plan.fill_seconds += own * kFillSecondsPerTet / speed;
  }
  const bool is_static = run.shot().settings.mode == SimulationMode::Static;
  const double steps = is_static ? kStaticStepsPerFrame : run.resolved(bodies.front()).solver.substeps;
  const int simulated = frames_to_simulate(run, bodies.front(), needed);
  plan.tets += tets;
  plan.simulated += simulated;
  plan.simulate_seconds += simulated * steps * tets * kStepSecondsPerTet / speed;
}

/// Of memory, beside the bodies: of the program, the pictures, what they show, and ffmpeg where it encodes them.
double other_bytes(const SceneStage& scenes, const Shot& shot, const FrameSpan& frames, bool traces) {
  const double pixels = static_cast<double>(shot.render.params.width) * shot.render.params.height;
  return kBytesOfProgram + pixels * kBytesPerPixel + (traces ? scenes.count_texels() * kBytesPerTexel : 0) +
         (makes_movie(shot, frames) ? kEncoderBytes + pixels * kEncoderBytesPerPixel : 0);
}

Plan make_plan(const ShotRun& run, const SceneStage& scenes, const PictureStage& pictures, const FrameSpan& frames,
               int threads) {
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
  for (const std::vector<std::size_t>& bodies : simulated_wholes(shot)) {
    add_whole(run, bodies, needed, speed, plan);
    plan.simulated_of += frames.last - first_simulated_frame(shot) + 1;
  }
  const double pixels = static_cast<double>(shot.render.params.width) * shot.render.params.height;
  plan.render_seconds = plan.traced * pixels * shot.render.params.samples / (kPathsPerSecond * speed);
  plan.bytes = plan.tets * kBytesPerTet + plan.triangles * kBytesPerTriangle +
               other_bytes(scenes, shot, frames, plan.traced > 0);
  return plan;
}

/// Whether a render would remove anything: pictures of an older shot, or a movie of them.
bool has_outdated(const Session& session, const PictureStage& pictures, const Outputs& outputs) {
  const FrameSpan& frames = session.frames();
  const ShotSettings& settings = session.shot().settings;
  return pictures.has_outdated(frames.first, frames.last) ||
         (session.is_whole() && !outputs.pictures_outside(frames.first, frames.last).empty()) ||
         is_movie_outdated(session.shot(), settings.first_frame, settings.last_frame, outputs);
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

void print_json(const Session& session, const Plan& plan) {
  const Shot& shot = session.shot();
  const FrameSpan& frames = session.frames();
  const nlohmann::ordered_json json{{"command", "plan"},
                                    {"shot", shot.path},
                                    {"name", shot.settings.name},
                                    {"output", shot.output.directory},
                                    {"frames", {frames.first, frames.last}},
                                    {"complete", plan.complete},
                                    {"tetrahedra", plan.tets},
                                    {"triangles", plan.triangles},
                                    {"simulate", {{"missing", plan.simulated}, {"of", plan.simulated_of}}},
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
  Plan plan = make_plan(run, scenes, pictures, frames, session.context().threads.count());
  plan.complete =
      plan.kept == frames.count() && has_the_rest(session, outputs) && !has_outdated(session, pictures, outputs);
  if (options.json) {
    print_json(session, plan);
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
      "  simulate %d of %d body frames (%s), the others are stored or not needed\n", plan.simulated, plan.simulated_of,
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

PlanEstimate estimate_plan(const ShotRun& run, const SceneStage& scenes, const PictureStage& pictures,
                           const FrameSpan& frames, int threads) {
  const Plan plan = make_plan(run, scenes, pictures, frames, threads);
  return {plan.bytes, plan.fill_seconds, plan.simulate_seconds, plan.render_seconds, plan.traced};
}

}  // namespace softreel
