/// Times update and solve of the multigrid solver on the bar of the targets, and the three Galerkin products.
///
/// multigrid_benchmark [THREADS [CUBES_ACROSS...]] prints tab-separated values; medians over repeats. Default: 1
/// thread, bars of 6, 9 and 11 cubes across (11k, 37k, 67k tetrahedra).
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <vector>

#include <fmt/format.h>

#include "core/base/parallel.h"
#include "core/multigrid/lattice_hierarchy.h"
#include "core/multigrid/multigrid.h"
#include "core/sparse/block_kernels.h"
#include "core/sparse/galerkin_gather.h"
#include "core/sparse/galerkin_product.h"
#include "core/sparse/galerkin_stream.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using test_support::ElasticSystem;

/// Now, s: processor time on one thread, which other jobs of a shared machine disturb least; wall time on several.
double now(const Threads& threads) {
  if (threads.count() == 1) return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median_seconds(const Threads& threads, int repeats, const std::function<void()>& work) {
  std::vector<double> times;
  for (int i = 0; i < repeats; ++i) {
    const double start = now(threads);
    work();
    times.push_back(now(threads) - start);
  }
  std::nth_element(times.begin(), times.begin() + repeats / 2, times.end());
  return times[static_cast<std::size_t>(repeats / 2)];
}

ElasticSystem make_system(const TetMesh& mesh, double seconds) {
  test_support::ElasticParams params;
  params.seconds = seconds;
  return test_support::assemble(mesh, params, [](const Vec3& x) { return x[0] < 1e-9; });
}

void time_solver(const TetMesh& mesh, const ElasticSystem& system, const char* name, const Threads& threads) {
  Multigrid multigrid(mesh, {}, system.matrix.pattern, {}, threads);
  std::vector<Vec3> x(mesh.nodes.size());
  SolveReport report;
  const double update = median_seconds(threads, 15, [&] { multigrid.update(system.matrix, system.pinned); });
  const double solve = median_seconds(threads, 15, [&] {
    std::fill(x.begin(), x.end(), Vec3::Zero());
    report = multigrid.solve(system.matrix, system.load, x, 1e-6, 0, 400);
  });
  fmt::print("{}\t{}\t{}\t{}\t{:.2f}\t{:.2f}\t{:.2f}\t{}\n", mesh.tets.size(), name, threads.count(), report.iterations,
             1e3 * update, 1e3 * solve, 1e3 * (update + solve), report.double_cycle ? "double" : "float");
}

/// ns per block of the finest matrix, in float.
void time_products(const TetMesh& mesh, const ElasticSystem& system, const Threads& threads) {
  const LatticeHierarchy hierarchy = build_lattice_hierarchy(mesh, {}, system.matrix.pattern, {});
  if (hierarchy.levels.size() < 2) return;
  const LatticeLevel& fine = hierarchy.levels[0];
  BlockMatrixf K{fine.pattern, {}}, E{hierarchy.levels[1].pattern, {}};
  reserve_values(K);
  reserve_values(E);
  for (std::size_t b = 0; b < hierarchy.source_blocks.size(); ++b)
    for (std::size_t k = 0; k < 9; ++k)
      K.values[9 * b + k] = static_cast<float>(system.matrix.block(hierarchy.source_blocks[b])[k]);
  const GalerkinStream<float> stream(K.pattern, fine.prolongation, E.pattern);
  const GalerkinGather<float> gather(K.pattern, fine.prolongation, E.pattern, fine.rank);
  const double per_block = 1e9 / static_cast<double>(K.pattern.blocks());
  const double naive_ns = per_block * median_seconds(threads, 3, [&] { galerkin_product(K, fine.restriction, E); });
  const double stream_ns = per_block * median_seconds(threads, 15, [&] { stream.run(K, E); });
  const double gather_ns = per_block * median_seconds(threads, 15, [&] { gather.run(K, E, threads); });
  fmt::print("{}\tgalerkin ns/block\t{}\t{:.2f}\t{:.2f}\t{:.2f}\t{:.2f} products/block\n", mesh.tets.size(),
             threads.count(), naive_ns, stream_ns, gather_ns,
             static_cast<double>(gather.products()) / static_cast<double>(K.pattern.blocks()));
}

void run(int thread_count, const std::vector<Index>& sizes) {
  const Threads threads(thread_count);
  fmt::print("tets\tcase\tthreads\titerations\tupdate_ms\tsolve_ms\tboth_ms\tcycle\n");
  for (const Index across : sizes) {
    const TetMesh mesh = test_support::make_bar(across);
    const ElasticSystem dynamic = make_system(mesh, 1.0 / 96), statics = make_system(mesh, 0);
    time_solver(mesh, dynamic, "dynamic", threads);
    time_solver(mesh, statics, "static", threads);
  }
  fmt::print("tets\tcase\tthreads\tnaive\tstream\tgather\tproducts\n");
  for (const Index across : sizes) {
    const TetMesh mesh = test_support::make_bar(across);
    time_products(mesh, make_system(mesh, 1.0 / 96), threads);
  }
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  std::vector<softreel::Index> sizes;
  for (int i = 2; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
  if (sizes.empty()) sizes = {6, 9, 11};
  softreel::run(argc > 1 ? std::atoi(argv[1]) : 1, sizes);
}
