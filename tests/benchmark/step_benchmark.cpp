/// Times dynamic steps of the bar of the targets (sec. 5) under its weight, stage by stage.
///
/// step_benchmark [THREADS [STEPS [CUBES_ACROSS...]]] prints tab-separated values. Default: 1 thread, 48 steps after 16
/// that are not counted, bars of 6, 9, 11 cubes across (11k, 37k, 67k tetrahedra) and of 12k and 66k in Kuhn's cut.
/// Stages: wall time of a step in a typical frame (lower quartile), in ns a tetrahedron. Steps a second: processor time
/// on one thread, which other jobs of a shared machine disturb least; wall time on several.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/dynamics/simulator.h"
#include "tests/support/bcc_bar.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

constexpr int kWarmUp = 16;
constexpr int kSubsteps = 4;  ///< of a frame
constexpr double kSeconds = 1.0 / (24 * kSubsteps);

/// The bar, held at its low x end.
BodyModel bar_model(TetMesh mesh) {
  BodyModel model;
  model.name = "body.bar";
  model.materials.assign(mesh.tets.size(), {1e6, 0.4, 1000, 0.1, 0.002});
  model.surface_points = mesh.nodes;
  model.embedding = testing::embed_nodes(mesh);
  Pin pin{"body.bar.pin[0]", {}, {{{0, Transform{}, Ease::Constant}}}, {}};
  pin.points = testing::select_nodes(mesh, [](const Vec3& x) { return x[0] < 1e-9; });
  model.pins = {pin};
  model.mesh = std::move(mesh);
  return model;
}

double now(const Threads& threads) {
  timespec time{};
  clock_gettime(threads.count() == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The lower quartile: a typical frame on a machine that others disturb.
double typical(std::vector<double> values) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

std::map<std::string, double> seconds_by_stage(const StageTimes& times) {
  std::map<std::string, double> seconds;
  for (const auto& [name, entry] : times.entries()) seconds[name] = entry.seconds;
  return seconds;
}

void time_steps(const char* cut, TetMesh mesh, int steps, const Threads& threads) {
  const Log log;
  StageTimes times;
  const auto tets = static_cast<double>(mesh.tets.size());
  Simulator simulator(bar_model(std::move(mesh)), SolverParams{}, threads, log, times);
  std::map<std::string, std::vector<double>> stages;
  std::vector<double> whole;
  int iterations = 0;
  for (int frame = 1; frame <= (kWarmUp + steps) / kSubsteps; ++frame) {
    const std::map<std::string, double> before = seconds_by_stage(times);
    const double start = now(threads);
    int frame_iterations = 0;
    for (int s = 1; s <= kSubsteps; ++s) {
      const StepReport report = simulator.step(frame - 1 + static_cast<double>(s) / kSubsteps, kSeconds);
      if (!report.ok()) throw std::runtime_error("a step of the benchmark was not solved");
      frame_iterations += report.solve.iterations;
    }
    const double seconds = now(threads) - start;
    if (frame <= kWarmUp / kSubsteps) continue;
    iterations += frame_iterations;
    // Means of a frame, as its first step makes the coarse levels that the others may keep.
    whole.push_back(seconds / kSubsteps);
    for (const auto& [name, after] : seconds_by_stage(times))
      stages[name].push_back((after - before.at(name)) / kSubsteps);
  }
  fmt::print("{}\t{}\t{}", cut, tets, threads.count());
  double rest = typical(whole);
  for (const char* name : {"rotate", "assemble", "update", "solve"}) {
    const double stage = typical(stages.at(std::string("simulate/") + name));
    rest -= stage;
    fmt::print("\t{:.1f}", 1e9 / tets * stage);
  }
  double lowest = 1;
  for (const Vec3& x : simulator.state().positions) lowest = std::min(lowest, x.y());
  fmt::print("\t{:.1f}\t{:.1f}\t{:.1f}\t{:.2f}\t{:.12f}\n", 1e9 / tets * rest, 1e9 / tets * typical(whole),
             1 / typical(whole), static_cast<double>(iterations) / static_cast<double>(kSubsteps * whole.size()),
             lowest);
}

void run(int thread_count, int steps, const std::vector<Index>& sizes) {
  const Threads threads(thread_count);
  fmt::print("cut\ttets\tthreads\trotate\tassemble\tupdate\tsolve\trest\tstep\tsteps/s\titerations\tlowest y, m\n");
  for (const Index across : sizes) time_steps("bcc", test_support::make_bar(across), steps, threads);
  for (const Index across : sizes) {
    const int n = across + (across > 8 ? 3 : 2);
    time_steps("kuhn", testing::kuhn_bar({4 * n, n, n}, Vec3(1, 0.25, 0.25)), steps, threads);
  }
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  std::vector<softreel::Index> sizes;
  for (int i = 3; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
  if (sizes.empty()) sizes = {6, 9, 11};
  softreel::run(argc > 1 ? std::atoi(argv[1]) : 1, argc > 2 ? std::atoi(argv[2]) : 48, sizes);
}
