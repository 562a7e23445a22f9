#include "tests/benchmark/precision/creature.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "core/constraints/selection.h"
#include "core/mesh/mesh_repair.h"
#include "core/mesh/placement.h"
#include "core/mesh/readers/mesh_import.h"
#include "core/skinning/skinning.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/benchmark/bench.h"
#include "tests/benchmark/precision/static_answer.h"

namespace softreel::bench {
namespace {

constexpr double kHeight = 1, kLasts = 18 / kFps;
constexpr ElementMaterial kFoam{1.2e5, 0.4, 300, 0.4, 0};  ///< presets/materials/rubber.toml, without K's damping
const Vec3 kWeakGravity(0, -1.5, 0);

Log silent() {
  return Log{[](const std::string&) {}, [](const std::string&) {}};
}

std::vector<Index> points_in(const SurfaceMesh& surface, const Vec3& min, const Vec3& max) {
  return select_points({{{SelectBox{min, max}, SelectionUnit::Box}}}, surface);
}

Pull head_pull(const SurfaceMesh& surface) {
  Transform down, up;
  down.translate = Vec3(0.05, -0.10, 0.03) * kHeight;
  up.translate = Vec3(0.14, 0.42, 0.05) * kHeight;
  Pull pull{"creature.pull[0]",
            points_in(surface, Vec3(0, 0.84, 0), Vec3(1, 1, 1)),
            {},
            {{{0, Transform{}, Ease::Smooth}, {6, down, Ease::Smooth}, {kLasts * kFps, up, Ease::Smooth}}},
            {{{0, 16000, Ease::Constant}}},
            0,
            {}};
  pull.weights.assign(pull.points.size(), 1.0 / static_cast<double>(pull.points.size()));
  return pull;
}

/// Meshes that the truth is led on from, one with edges about half as long as the other's: the creature's error is that
/// its pins hold whole tetrahedra and its surface is cut by them, which is of first order in the edge.
struct TruthMeshes {
  BodyModel fine, coarse;
  double edge_ratio() const {
    return std::cbrt(static_cast<double>(fine.mesh.tets.size()) / static_cast<double>(coarse.mesh.tets.size()));
  }
};
constexpr double kMeshOrder = 1;

TruthMeshes make_truth_meshes(const SurfaceMesh& surface, std::int64_t tets) {
  return {make_creature(surface, tets), make_creature(surface, tets / 8)};
}

/// A truth and how far it was led on, which bounds what it can be wrong by.
struct MeshTruth {
  ShapeSamples samples;
  double doubt = 0;  ///< m
};

MeshTruth lead_on(const ShapeSamples& fine, const ShapeSamples& coarse, const TruthMeshes& meshes) {
  MeshTruth truth{led_on(fine, coarse, meshes.edge_ratio()), 0};
  truth.doubt = rms_distance(truth.samples, fine);
  return truth;
}

double mean_height(const std::vector<Vec3>& points) {
  double sum = 0;
  for (const Vec3& p : points) sum += p.y();
  return sum / static_cast<double>(points.size());
}

std::vector<Method> chosen_methods() {
  std::vector<Method> chosen;
  for (Method& method : softreel_schemes())
    if (method.label == "Euler, start" || method.label == "BDF2, predictor" || method.label == "Newmark, predictor") {
      method.tolerances = {1e-3};
      chosen.push_back(std::move(method));
    }
  for (Method& method : softreel_variants()) {
    method.tolerances = {1e-3};
    chosen.push_back(std::move(method));
  }
  for (Method& method : rival_methods()) {
    if (method.tolerances.size() > 1) method.tolerances = {1e-3};
    chosen.push_back(std::move(method));
  }
  return chosen;
}

/// Order in the mesh width where every mesh takes the reference's own steps, so that little of time is in the error.
OrderRow order_at_short_steps(MotionProblem problem, const std::vector<BodyModel>& models,
                              const ShapeSamples& reference, const SurfaceMesh& surface, const Method& exact) {
  std::vector<WorkPoint> points;
  for (const BodyModel& model : models) {
    problem.model = model;
    problem.observe = [&] {
      return observe_shape(reference, kHeight,
                           [&model](std::span<const Vec3> positions) { return surface_of(model, positions); },
                           surface.positions, {0});
    };
    points.push_back(run_motion(problem, exact, problem.steps.back() / 2, kNone));
  }
  OrderRow row = order_in_mesh(points, exact.label, kMeshOrder);
  row.method = "BDF2, predictor";
  return row;
}

std::string motion_text(const TruthMeshes& meshes, double doubt, int halvings) {
  return fmt::format(
      "assets/creature.ply, 1 m high, foam rubber (E = 1.2e5 Pa, nu = 0.4, 300 kg/m^3, damping 0.4 / s of mass), g = "
      "1.5 m/s^2; soles pinned, a spring of 16000 N/m presses the top of the head down for 6 frames and pulls it up by "
      "0.42 m for 12 more. Truth: the surface by BDF2 in {:.0f} steps a second on {} and {} tetrahedra, led on by "
      "first order in the edge, since the pins hold whole tetrahedra: how far up the soles they reach changes with "
      "the mesh. It was led on by {:.2g} of the height, which bounds what it can be wrong by and is not small beside "
      "the errors of the finest meshes: an error below twice that says little. A method that is too soft because it "
      "stops short of its equations can come nearer to the truth than it deserves on a mesh that is too stiff.",
      2 * kFps * (1 << (halvings - 1)), meshes.fine.mesh.tets.size(), meshes.coarse.mesh.tets.size(), doubt / kHeight);
}

ProblemResult measure_motion(const SurfaceMesh& surface, const std::vector<BodyModel>& models,
                             const TruthMeshes& meshes, int halvings, double most_seconds) {
  ProblemResult result{"creature", "A creature pulled by its head: surface against its converged motion", "", {}, {},
                       {}};
  const std::vector<double> times{6 / kFps, 12 / kFps, kLasts};
  const Method exact{"reference", "", true, "", {kNone}, 1, [](const BodyModel& model, double, const Threads& threads) {
                       return make_softreel(model, scheme_params(Integrator::Bdf2, Linearize::Predictor, 1e-4),
                                            threads);
                     }};
  const auto map_of = [](const BodyModel& model) -> ShapeMap {
    return [&model](std::span<const Vec3> positions) { return surface_of(model, positions); };
  };
  MotionProblem problem{result.name, meshes.coarse, kLasts, halved_frames(halvings), most_seconds, {}};
  const auto samples_of = [&](const BodyModel& model) {
    problem.model = model;
    return find_samples(problem, exact, problem.steps.back() / 2, kNone, times, map_of(model));
  };
  const MeshTruth truth = lead_on(samples_of(meshes.fine), samples_of(meshes.coarse), meshes);
  const ShapeSamples& reference = truth.samples;
  std::vector<Index> all(surface.positions.size());
  std::iota(all.begin(), all.end(), 0);
  Pace pace;
  for (const BodyModel& model : models) {
    problem.model = model;
    problem.observe = [&] { return observe_shape(reference, kHeight, map_of(model), surface.positions, all); };
    const std::vector<WorkPoint> points = sweep(problem, chosen_methods(), pace);
    result.points.insert(result.points.end(), points.begin(), points.end());
  }
  result.orders.push_back(order_at_short_steps(problem, models, reference, surface, exact));
  result.text = motion_text(meshes, truth.doubt, halvings);
  return result;
}

/// Order of the schemes in the step: the motion of one mesh against itself in short steps.
void add_step_orders(ProblemResult& result, const BodyModel& model, int halvings) {
  std::vector<double> steps = halved_frames(halvings);
  steps.erase(steps.begin(), steps.end() - 3);
  MotionProblem problem{"creature, one mesh", model, kLasts, steps, 20, {}};
  const ShapeMap all = [](std::span<const Vec3> positions) {
    return std::vector<Vec3>(positions.begin(), positions.end());
  };
  const Method exact{"reference", "", true, "", {kNone}, 1, [](const BodyModel& m, double, const Threads& threads) {
                       return make_softreel(m, scheme_params(Integrator::Bdf2, Linearize::Predictor, 1e-7), threads);
                     }};
  const ShapeSamples reference =
      find_samples(problem, exact, problem.steps.back() / 4, kNone, {6 / kFps, 12 / kFps, kLasts}, all);
  problem.observe = [&] { return observe_shape(reference, kHeight, all, model.mesh.nodes, {0}); };
  Pace pace;
  for (const auto& [label, order] :
       {std::pair("Euler, start", 1), std::pair("BDF2, predictor", 2), std::pair("Newmark, predictor", 2)}) {
    std::vector<Method> methods = chosen_methods();
    std::erase_if(methods, [&](const Method& method) { return method.label != label; });
    methods.front().tolerances = {1e-6};
    result.orders.push_back(order_in_step(sweep(problem, methods, pace), label, order));
  }
}

ProblemResult measure_rest(const SurfaceMesh& surface, const std::vector<BodyModel>& models,
                           const TruthMeshes& meshes) {
  ProblemResult result{
      "creature at rest", "The creature under its weight: surface against its converged shape", "", {}, {}, {}};
  const auto rest_of = [](BodyModel model, double tolerance, double& seconds) {
    model.pulls.clear();
    model.gravity = 2 * kWeakGravity;
    SolverParams params = uncapped_params();
    params.force_tolerance = tolerance;
    const StaticAnswer answer = time_static_answer(model, params);
    seconds = answer.seconds;
    return surface_of(model, answer.positions);
  };
  double seconds = 0;
  const auto samples_of = [&](const BodyModel& model) {
    ShapeSamples samples;
    samples.times = {0};
    samples.positions.push_back(rest_of(model, 1e-6, seconds));
    return samples;
  };
  const MeshTruth truth = lead_on(samples_of(meshes.fine), samples_of(meshes.coarse), meshes);
  const std::vector<Vec3>& reference = truth.samples.positions.front();
  const double sag = rms_distance(surface.positions, reference);
  for (const BodyModel& model : models)
    for (const double tolerance : {1e-3, 1e-6}) {
      WorkPoint point;
      point.problem = result.name;
      point.method = point.curve = "softreel";
      point.ours = true;
      point.tets = static_cast<long>(model.mesh.tets.size());
      point.tolerance = tolerance;
      const std::vector<Vec3> shape = rest_of(model, tolerance, point.seconds);
      point.value = mean_height(shape) - mean_height(surface.positions);
      // Of what the weight does, which is little of the height.
      point.error = rms_distance(shape, reference) / sag;
      result.points.push_back(point);
    }
  result.orders.push_back(order_in_mesh(result.points, "softreel", kMeshOrder));
  result.text = fmt::format(
      "The same creature without the pull under 3 m/s^2, in equilibrium; error over the root mean square displacement "
      "of its surface. Truth: led on in the same way, by {:.2g} of that displacement.",
      truth.doubt / sag);
  return result;
}

}  // namespace

SurfaceMesh load_creature() {
  SurfaceMesh surface = import_mesh(SOFTREEL_SOURCE_DIR "/assets/creature.ply", silent());
  repair_mesh(surface);
  PlacementParams params;
  params.fit = kHeight;
  apply(place(surface, params), surface);
  return surface;
}

BodyModel make_creature(const SurfaceMesh& surface, std::int64_t tets) {
  const Threads threads(1);
  StageTimes times;
  BodyModel model;
  model.name = "creature";
  model.mesh = tetrahedralize(surface, {.tets = tets}, model.name, threads, silent(), times);
  model.materials.assign(model.mesh.tets.size(), kFoam);
  model.surface_points = surface.positions;
  model.embedding = embed_points(surface.positions, vertex_normals(surface, surface.positions), model.mesh, threads);
  model.gravity = kWeakGravity;
  model.pins = {{"creature.pin[0]",
                 points_in(surface, Vec3::Zero(), Vec3(1, 0.05, 1)),
                 {{{0, Transform{}, Ease::Constant}}},
                 {}}};
  model.pulls = {head_pull(surface)};
  return model;
}

std::vector<Vec3> surface_of(const BodyModel& model, std::span<const Vec3> positions) {
  return skin_positions(model.surface_points, model.embedding, model.mesh,
                        std::vector<Vec3>(positions.begin(), positions.end()), Threads(1));
}

std::vector<ProblemResult> measure_creature(bool quick) {
  const SurfaceMesh surface = load_creature();
  std::vector<BodyModel> models;
  for (const std::int64_t tets :
       quick ? std::vector<std::int64_t>{2000, 4000, 8000} : std::vector<std::int64_t>{2000, 8000, 32000, 100000})
    models.push_back(make_creature(surface, tets));
  const TruthMeshes meshes = make_truth_meshes(surface, quick ? 25000 : 250000);
  const int halvings = quick ? 3 : 4;
  std::vector<ProblemResult> results;
  results.push_back(measure_motion(surface, models, meshes, halvings, quick ? 0.5 : 4));
  add_step_orders(results.back(), models.front(), quick ? 6 : 8);
  results.push_back(measure_rest(surface, models, meshes));
  return results;
}

}  // namespace softreel::bench
