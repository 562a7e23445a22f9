#include <algorithm>
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

/// Measured on 2 cores with the shots of presets/ (README, "How fast"); a plan is right within a factor of
/// two or so there, and scales with the machine elsewhere.
constexpr double kStepSecondsPerTet = 3.2e-7;  ///< one dynamic step with one solve, two threads
constexpr double kStaticStepsPerFrame = 6.5;   ///< a static frame costs about this many steps
constexpr double kIteratedSteps = 11;          ///< and a step that is iterated this many
/// Distance, fit and embedding are of the surface; lattices, which graded ones are grown to, of the tetrahedra.
constexpr double kFillSecondsPerTriangle = 2.6e-6, kFillSecondsPerTet = 2e-6, kFillSecondsPerGradedTet = 1e-5;
constexpr double kPathsPerSecond = 2e6;    ///< two threads
constexpr double kDeepPaths = 2;           ///< what a path costs more where light goes into bodies
constexpr double kBytesPerTet = 1200;      ///< matrix, hierarchy, state
constexpr double kBytesPerTriangle = 700;  ///< surface, normals, trees
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

double fill_seconds(const BodySettings& body, const LoadedBody& loaded, double tets) {
  if (loaded.given) return 0;
  return kFillSecondsPerTriangle * static_cast<double>(loaded.surface.triangles.size()) +
         (body.graded || body.error.value > 0 ? kFillSecondsPerGradedTet : kFillSecondsPerTet) * tets;
}

/// Steps of one solve that a frame costs.
double steps_per_frame(const Shot& shot, const SolverParams& solver) {
  if (shot.settings.mode == SimulationMode::Static) return kStaticStepsPerFrame;
  return solver.substeps * (linearization(solver) == Linearize::Iterated ? kIteratedSteps : 1);
}

/// What a path costs, of one that stays outside of bodies.
double path_cost(const Shot& shot) {
  const auto lets_light_in = [&](const BodySettings& body) {
    const Appearance& look = shot.materials.at(body.material).appearance;
    return look.transmission > 0 || look.subsurface > 0;
  };
  return std::any_of(shot.bodies.begin(), shot.bodies.end(), lets_light_in) ? kDeepPaths : 1;
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
      plan.fill_seconds += fill_seconds(run.settings(b), run.loaded(b), own) / speed;
  }
  const double steps = steps_per_frame(run.shot(), run.resolved(bodies.front()).solver);
  const int simulated = frames_to_simulate(run, bodies.front(), needed);
  plan.tets += tets;
  plan.simulated += simulated;
  plan.simulate_seconds += simulated * steps * tets * kStepSecondsPerTet / speed;
}

void add_simulation(const ShotRun& run, const std::vector<int>& needed, int last, double speed, Plan& plan) {
  for (const std::vector<std::size_t>& bodies : simulated_wholes(run.shot())) {
    add_whole(run, bodies, needed, speed, plan);
    plan.simulated_of += last - first_simulated_frame(run.shot()) + 1;
  }
  plan.bytes = plan.tets * kBytesPerTet + plan.triangles * kBytesPerTriangle + kBytesOfProgram;
}

/// Of memory: of the pictures, what they show, and ffmpeg where it encodes them.
double picture_bytes(const SceneStage& scenes, const Shot& shot, const FrameSpan& frames, bool traces) {
  const double pixels = static_cast<double>(shot.render.params.width) * shot.render.params.height;
  return pixels * kBytesPerPixel + (traces ? scenes.count_texels() * kBytesPerTexel : 0) +
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
  add_simulation(run, needed, frames.last, speed, plan);
  const double pixels = static_cast<double>(shot.render.params.width) * shot.render.params.height;
  const double paths = plan.traced * pixels * shot.render.params.samples;
  plan.render_seconds = paths * path_cost(shot) / (kPathsPerSecond * speed);
  plan.bytes += picture_bytes(scenes, shot, frames, plan.traced > 0);
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

nlohmann::ordered_json begin_json(const Session& session, const Plan& plan) {
  const Shot& shot = session.shot();
  return {{"command", "plan"},
          {"shot", shot.path},
          {"name", shot.settings.name},
          {"output", shot.output.directory},
          {"frames", {session.frames().first, session.frames().last}},
          {"complete", plan.complete},
          {"tetrahedra", plan.tets},
          {"triangles", plan.triangles},
          {"simulate", {{"missing", plan.simulated}, {"of", plan.simulated_of}}}};
}

nlohmann::ordered_json expected_json(const Plan& plan) {
  return {{"bytes", plan.bytes},
          {"seconds", plan.fill_seconds + plan.simulate_seconds + plan.render_seconds},
          {"fill_seconds", plan.fill_seconds},
          {"simulate_seconds", plan.simulate_seconds},
          {"render_seconds", plan.render_seconds}};
}

/// What is to be done before any file is made.
void print_bodies(const Session& session, const ShotRun& run, const Plan& plan) {
  const Shot& shot = session.shot();
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
}

/// render: of the pictures; empty where none are made.
void print_expected(const Plan& plan, const std::string& render) {
  std::printf("  expected, within a factor of two: memory %s; time %s (fill %s, simulate %s%s)\n",
              format_bytes(plan.bytes).c_str(),
              format_duration(plan.fill_seconds + plan.simulate_seconds + plan.render_seconds).c_str(),
              format_duration(plan.fill_seconds).c_str(), format_duration(plan.simulate_seconds).c_str(),
              render.c_str());
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
    nlohmann::ordered_json json = begin_json(session, plan);
    json["trace"] = {{"missing", plan.traced}, {"there", plan.kept}, {"of", frames.count()}};
    json["expected"] = expected_json(plan);
    std::printf("%s\n", json_text(json).c_str());
    return 0;
  }
  print_bodies(session, run, plan);
  std::printf("  trace %d of %d frames of %d x %d at %d samples to %s\n", plan.traced, frames.count(),
              shot.render.params.width, shot.render.params.height, shot.render.params.samples,
              shot.output.directory.c_str());
  print_expected(plan, ", render " + format_duration(plan.render_seconds));
  return 0;
}

int run_plan(const ShotOptions& options, const std::function<PlannedWork(ShotRun&, Outputs&)>& find_work) {
  ShotOptions silent = options;
  silent.quiet = true;
  const Session session(silent);
  const Shot& shot = session.shot();
  ShotRun run(shot, session.context(), DialUse::LookUp);
  Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
  const PlannedWork work = find_work(run, outputs);
  Plan plan;
  add_simulation(run, work.frames, session.frames().last, session.context().threads.count() / 2.0, plan);
  plan.complete = work.missing == 0 && work.outdated == 0 && plan.simulated == 0;  // none: unknown
  if (options.json) {
    nlohmann::ordered_json json = begin_json(session, plan);
    if (work.of > 0) json["files"] = {{"missing", work.missing}, {"of", work.of}};
    if (work.of > 0 && work.outdated) json["files"]["outdated"] = *work.outdated;
    json["expected"] = expected_json(plan);
    std::printf("%s\n", json_text(json).c_str());
    return 0;
  }
  print_bodies(session, run, plan);
  for (const std::string& line : work.lines) std::printf("  %s\n", line.c_str());
  print_expected(plan, "");
  return 0;
}

PlanEstimate estimate_plan(const ShotRun& run, const SceneStage& scenes, const PictureStage& pictures,
                           const FrameSpan& frames, int threads) {
  const Plan plan = make_plan(run, scenes, pictures, frames, threads);
  return {plan.bytes, plan.fill_seconds, plan.simulate_seconds, plan.render_seconds, plan.traced};
}

}  // namespace softreel
