/// Shows what skipping saves, and that it changes no answer beyond the solver's tolerance.
///
/// skip_benchmark [THREADS] prints tab-separated values. Cases: a long bar, clamped in the middle, one end of which is
/// pulled aside (half of it hardly moves); the same bar, heavily damped, pulled soon and watched until it is at rest.
/// `difference` is from the run that skips nothing, `error` from one with a tolerance of 1e-10, both the greatest of
/// all nodes and frames over the greatest way that a node goes.
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "core/dynamics/frame_steps.h"
#include "tests/support/bcc_bar.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

constexpr double kFps = 24;

struct Case {
  const char* name;
  int pull_until;  ///< frame where the pull has its greatest way
  int frames;
  bool starts_balanced;
  double damping_mass;  ///< 1/s
};

constexpr Case kCases[] = {{"half_moves", 48, 48, true, 0.5}, {"comes_to_rest", 6, 240, true, 8}};

BodyModel bar_model(const Case& problem) {
  BodyModel model;
  model.name = "body.bar";
  model.mesh = test_support::make_box({6, 6, 72}, 0.02);
  model.materials.assign(model.mesh.tets.size(), {3e5, 0.35, 1000, problem.damping_mass, 0.005});
  model.surface_points = model.mesh.nodes;
  model.embedding = testing::embed_nodes(model.mesh);
  const auto between = [&](double low, double high) {
    return testing::select_nodes(model.mesh, [=](const Vec3& p) { return p.z() > low && p.z() < high; });
  };
  model.pins = {{"body.bar.pin[0]", between(0.65, 0.79), {{{0, Transform{}, Ease::Constant}}}, {}}};
  Transform aside;
  aside.translate = Vec3(0.1, 0.05, 0);
  Pull pull{"body.bar.pull[0]",
            between(1.42, 2),
            {},
            {{{0, {}, Ease::Smooth}, {static_cast<double>(problem.pull_until), aside, Ease::Smooth}}},
            {{{0, 40.0, Ease::Constant}}},
            0,
            {}};
  pull.weights.assign(pull.points.size(), 1.0 / static_cast<double>(pull.points.size()));
  model.pulls = {pull};
  return model;
}

struct Skips {
  const char* name;
  double rest_tolerance;
  bool hierarchy;
  double matrix_lag;
};

constexpr Skips kSkips[] = {{"nothing", 0, false, 0},
                            {"rest", SolverParams{}.rest_tolerance, false, 0},
                            {"hierarchies", 0, true, 0},
                            {"hierarchies and matrices", 0, true, SolverParams{}.matrix_lag},
                            {"all", SolverParams{}.rest_tolerance, true, SolverParams{}.matrix_lag}};

struct Run {
  std::vector<std::vector<Vec3>> positions;  ///< per frame
  FrameReport work;                          ///< summed
  double cpu_seconds = 0;
};

Run simulate(const Case& problem, const Skips& skips, double tolerance, const Threads& threads) {
  SolverParams params;
  params.substeps = 4;
  params.rest_tolerance = skips.rest_tolerance;
  params.keep_hierarchy = skips.hierarchy;
  params.matrix_lag = skips.matrix_lag;
  params.tolerance = tolerance;
  const Log log;
  StageTimes times;
  Simulator simulator(bar_model(problem), params, threads, log, times);
  if (!simulator.find_equilibrium(0).ok()) throw std::runtime_error("no balance at the start");
  Run run;
  run.positions.push_back(simulator.state().positions);
  const std::clock_t start = std::clock();
  for (int frame = 1; frame <= problem.frames; ++frame) {
    const FrameReport report = advance_to_frame(
        simulator, frame, kFps, [] {}, [](int) {});
    if (!report.ok()) throw std::runtime_error("a step of the benchmark was not solved");
    run.work.steps += report.steps;
    run.work.steps_at_rest += report.steps_at_rest;
    run.work.kept_hierarchies += report.kept_hierarchies;
    run.work.kept_matrices += report.kept_matrices;
    run.work.linear_iterations += report.linear_iterations;
    run.positions.push_back(simulator.state().positions);
  }
  run.cpu_seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return run;
}

/// Greatest of all frames and nodes.
double greatest_distance(const Run& a, const Run& b) {
  double greatest = 0;
  for (std::size_t f = 0; f < a.positions.size(); ++f)
    for (std::size_t i = 0; i < a.positions[f].size(); ++i)
      greatest = std::max(greatest, (a.positions[f][i] - b.positions[f][i]).norm());
  return greatest;
}

double greatest_way(const Run& run) {
  double greatest = 0;
  for (const std::vector<Vec3>& frame : run.positions)
    for (std::size_t i = 0; i < frame.size(); ++i)
      greatest = std::max(greatest, (frame[i] - run.positions.front()[i]).norm());
  return greatest;
}

void compare(const Case& problem, const Threads& threads) {
  const Run exact = simulate(problem, kSkips[0], 1e-10, threads);
  const double way = greatest_way(exact);
  Run plain;
  for (const Skips& skips : kSkips) {
    const Run run = simulate(problem, skips, 1e-3, threads);
    if (skips.name == kSkips[0].name) plain = run;
    fmt::print("{}\t{}\t{}\t{}\t{}\t{:.1f}\t{}\t{:.1f}\t{:.2e}\t{:.2e}\n", problem.name, skips.name, run.work.steps,
               run.work.steps_at_rest, run.work.kept_hierarchies, 100 * run.work.kept_matrices / run.work.steps,
               run.work.linear_iterations, 1e3 * run.cpu_seconds / run.work.steps, greatest_distance(run, plain) / way,
               greatest_distance(run, exact) / way);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  const softreel::Threads threads(argc > 1 ? std::atoi(argv[1]) : 1);
  fmt::print(
      "case\tskipped\tsteps\tat_rest\tkept_hierarchies\tkept_matrices_%\titerations\tcpu_ms_a_step\tdifference\t"
      "error\n");
  for (const softreel::Case& problem : softreel::kCases) softreel::compare(problem, threads);
  return 0;
}
