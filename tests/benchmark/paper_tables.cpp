/// Prints Tables 1 and 2 of the paper again: times of the stages of a step on meshes of about its models' sizes, for
/// the rotations of eq. (3) and for the default ones.
///
/// paper_tables [--threads N] [--tets N] prints tab-separated values: a bar under its weight instead of Bunny, Horse
/// and Dragon (11k, 34k, 67k elements; --tets: one bar of about that many instead). Times are lower quartiles over
/// steps: processor time on one thread, wall time on several. update_ms: of a step, as the simulator does it;
/// update_*_ms: the whole hierarchy by eq. (9), by the stream of Algorithm 1 and by gathering, from a matrix in double.
/// bytes_per_tet: everything that the simulator allocates.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <malloc.h>

#include "core/dynamics/simulator.h"
#include "tests/support/bcc_bar.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

constexpr int kWarmUp = 8, kSteps = 24;
constexpr double kSeconds = 1.0 / 96;

double now(const Threads& threads) {
  timespec time{};
  clock_gettime(threads.count() == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double typical(std::vector<double> values) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

std::size_t allocated_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// The bar of the targets, held at its low x end.
BodyModel bar_model(const TetMesh& mesh) {
  BodyModel model;
  model.name = "bar";
  model.mesh = mesh;
  model.materials.assign(mesh.tets.size(), {1e6, 0.4, 1000, 0.1, 0.002});
  model.surface_points = mesh.nodes;
  model.embedding = testing::embed_nodes(mesh);
  Pin pin{"bar.pin[0]", {}, {{{0, Transform{}, Ease::Constant}}}, {}};
  pin.points = testing::select_nodes(mesh, [](const Vec3& x) { return x[0] < 1e-9; });
  model.pins = {pin};
  return model;
}

/// Milliseconds of one rebuild of the whole hierarchy.
double time_update(const TetMesh& mesh, GalerkinMethod method, int repeats, const Threads& threads) {
  test_support::ElasticParams params;
  params.seconds = kSeconds;
  const auto system = test_support::assemble(mesh, params, [](const Vec3& x) { return x[0] < 1e-9; });
  MultigridParams multigrid_params;
  multigrid_params.galerkin = method;
  Multigrid multigrid(mesh, {}, system.matrix.pattern, multigrid_params, threads);
  std::vector<double> seconds;
  for (int i = 0; i < repeats; ++i) {
    const double start = now(threads);
    multigrid.update(system.matrix, system.pinned);
    seconds.push_back(now(threads) - start);
  }
  return 1e3 * typical(seconds);
}

struct StepTimes {
  std::map<std::string, double> stage_ms;
  double steps_per_second = 0, bytes_per_tet = 0;
  std::size_t levels = 0;
};

StepTimes time_steps(const TetMesh& mesh, RotationMethod rotation, const Threads& threads) {
  const Log log;
  StageTimes times;
  BodyModel model = bar_model(mesh);
  SolverParams params;
  params.rotation = rotation;
  const std::size_t before = allocated_bytes();
  Simulator simulator(std::move(model), params, threads, log, times);
  std::map<std::string, std::vector<double>> stages;
  std::vector<double> steps;
  for (int step = 1; step <= kWarmUp + kSteps; ++step) {
    const auto entries = times.entries();
    const double start = now(threads);
    // Frames apart, so that every step makes its hierarchy, as in the paper.
    if (!simulator.step(step, kSeconds).ok()) throw std::runtime_error("a step of the benchmark was not solved");
    if (step <= kWarmUp) continue;
    steps.push_back(now(threads) - start);
    for (const auto& [name, entry] : times.entries()) {
      const auto earlier = entries.find(name);
      stages[name].push_back(entry.seconds - (earlier == entries.end() ? 0 : earlier->second.seconds));
    }
  }
  StepTimes result;
  for (const auto& [name, seconds] : stages) result.stage_ms[name] = 1e3 * typical(seconds);
  result.steps_per_second = 1 / typical(steps);
  result.bytes_per_tet = static_cast<double>(allocated_bytes() - before) / static_cast<double>(mesh.tets.size());
  result.levels = simulator.levels().size();
  return result;
}

void print_model(Index across, const Threads& threads) {
  const TetMesh mesh = test_support::make_bar(across);
  const double naive = time_update(mesh, GalerkinMethod::Naive, 3, threads);
  const double stream = time_update(mesh, GalerkinMethod::Stream, 9, threads);
  const double gather = time_update(mesh, GalerkinMethod::Gather, 9, threads);
  for (const auto& [name, method] :
       {std::pair("energy", RotationMethod::Energy), std::pair("consistent", RotationMethod::Consistent)}) {
    const StepTimes step = time_steps(mesh, method, threads);
    const auto ms = [&](const char* stage) { return step.stage_ms.at(std::string("simulate/") + stage); };
    fmt::print("bar_{}\t{}\t{}\t{}\t{}\t{}\t{:.2f}\t{:.2f}\t{:.2f}\t{:.2f}\t{:.2f}\t{:.2f}\t{:.2f}\t{:.1f}\t{:.0f}\n",
               across, mesh.tets.size(), mesh.nodes.size(), step.levels, threads.count(), name, ms("rotate"),
               ms("assemble"), ms("update"), naive, stream, gather, ms("solve"), step.steps_per_second,
               step.bytes_per_tet);
  }
}

/// Cubes across the bar that has the number of tetrahedra nearest to `tets`.
Index cubes_for(double tets) {
  return std::max(2, static_cast<Index>(std::lround(std::cbrt(tets / 48))));
}

int run(int argc, char** argv) {
  int threads = 1;
  std::vector<Index> sizes{cubes_for(11241), cubes_for(33689), cubes_for(67309)};
  for (int i = 1; i < argc; i += 2) {
    const std::string option = argv[i];
    const double value = i + 1 < argc ? std::atof(argv[i + 1]) : 0;
    if ((option != "--threads" && option != "--tets") || value < 1) {
      fmt::print(stderr, "paper_tables: {}: accepted: [--threads N] [--tets N], N at least 1\n", option);
      return 2;
    }
    if (option == "--threads") threads = static_cast<int>(value);
    if (option == "--tets") sizes = {cubes_for(value)};
  }
  fmt::print(
      "model\ttets\tnodes\tlevels\tthreads\trotation\trotate_ms\tassemble_ms\tupdate_ms\tupdate_naive_ms\t"
      "update_stream_ms\tupdate_gather_ms\tsolve_ms\tsteps_per_s\tbytes_per_tet\n");
  const Threads pool(threads);
  for (const Index across : sizes) print_model(across, pool);
  return 0;
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  return softreel::run(argc, argv);
}
