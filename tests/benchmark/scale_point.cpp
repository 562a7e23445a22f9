/// One point of `softreel bench scale`, in a process of its own, so that its peak of memory is its own.
///
/// scale_point TETS THREADS STEPS: fills the creature of the assets with about so many tetrahedra, pins its feet, and
/// lets it sag for STEPS steps of 1/96 s after one that is not counted. Prints one line, tab-separated: tetrahedra,
/// seconds of the filling, of the set-up (element matrices, hierarchy, first step), of a step (median), iterations a
/// step, peak bytes a tetrahedron of the filling and of the whole. Seconds are processor time on one thread, wall time
/// on several.
#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "core/constraints/selection.h"
#include "core/dynamics/simulator.h"
#include "core/mesh/mesh_repair.h"
#include "core/mesh/placement.h"
#include "core/mesh/readers/mesh_import.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/benchmark/bar_problem.h"
#include "tests/support/peak_memory.h"

namespace softreel {
namespace {

constexpr double kSeconds = 1.0 / 96;
constexpr int kStepsPerFrame = 4;

SurfaceMesh creature(const Log& log) {
  SurfaceMesh surface = import_mesh(SOFTREEL_SOURCE_DIR "/assets/creature.ply", log);
  repair_mesh(surface);
  apply(place(surface, {.fit = 1}), surface);
  return surface;
}

BodyModel model_of(const SurfaceMesh& surface, TetMesh mesh, const Threads& threads) {
  BodyModel model;
  model.name = "body.creature";
  model.materials.assign(mesh.tets.size(), benchmark_support::kBarMaterial);
  model.surface_points = surface.positions;
  model.embedding = embed_points(surface.positions, vertex_normals(surface, surface.positions), mesh, threads);
  Pin pin{"body.creature.pin[0]", {}, {{{0, Transform{}, Ease::Constant}}}, {}};
  pin.points = select_points({{{SelectBox{Vec3(0, 0, 0), Vec3(1, 0.1, 1)}, SelectionUnit::Box}}}, surface);
  model.pins = {pin};
  model.mesh = std::move(mesh);
  return model;
}

void measure(std::int64_t wanted, int thread_count, int steps) {
  using benchmark_support::now;
  const Threads threads(thread_count);
  const Log silent{[](const std::string&) {}, [](const std::string&) {}};
  StageTimes times;
  const SurfaceMesh surface = creature(silent);
  test::reset_peak_memory();
  const std::int64_t before = test::peak_memory();
  double start = now(threads);
  TetMesh mesh = tetrahedralize(surface, {.tets = wanted}, "body.creature", threads, silent, times);
  const double fill_seconds = now(threads) - start;
  const auto tets = static_cast<double>(mesh.tets.size());
  const auto bytes_a_tet = [&] { return static_cast<double>(test::peak_memory() - before) / tets; };
  const double fill_bytes = bytes_a_tet();

  start = now(threads);
  Simulator simulator(model_of(surface, std::move(mesh), threads), SolverParams{}, threads, silent, times);
  int iterations = 0;
  const auto step = [&](int s) {
    const StepReport report = simulator.step(static_cast<double>(s) / kStepsPerFrame, kSeconds);
    if (!report.ok()) throw std::runtime_error(fmt::format("step {} was not solved: {}", s, report.culprit));
    return report.solve.iterations;
  };
  step(1);
  const double setup_seconds = now(threads) - start;
  std::vector<double> seconds;
  for (int s = 2; s < 2 + steps; ++s) {
    start = now(threads);
    iterations += step(s);
    seconds.push_back(now(threads) - start);
  }
  fmt::print("{:.0f}\t{:.6g}\t{:.6g}\t{:.6g}\t{:.2f}\t{:.0f}\t{:.0f}\n", tets, fill_seconds, setup_seconds,
             benchmark_support::median(seconds), static_cast<double>(iterations) / steps, fill_bytes, bytes_a_tet());
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  const auto argument = [&](int k) { return argc > k ? std::atol(argv[k]) : 0; };
  if (argument(1) < 10 || argument(2) < 1 || argument(3) < 1) {
    fmt::print(stderr, "scale_point: accepted: TETS THREADS STEPS, at least 10, 1 and 1\n");
    return 2;
  }
  try {
    softreel::measure(argument(1), static_cast<int>(argument(2)), static_cast<int>(argument(3)));
  } catch (const std::exception& error) {
    fmt::print(stderr, "scale_point: {}\n", error.what());
    return 1;
  }
}
