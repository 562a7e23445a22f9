/// One cycle in float over all levels, V on the finest level and W below.
///
/// Bound: the smoothing of the finest level, 120 bytes a block, and about a fifth more below.
/// Measured / bound at 64k tetrahedra and 25 GB/s of L3, one core: W 9.1 / 5.8 ns (1.6), V 9.6.
#include "core/multigrid/v_cycle.h"
#include "tests/benchmark/kernels/kernel_problem.h"

namespace softreel::kernels {
namespace {

void run(benchmark::State& state, CycleKind kind) {
  Problem problem(state.range(0));
  MultigridParams params;
  params.coarse_cycle = kind;
  Cycle<float> cycle(problem.hierarchy, params, problem.threads);
  if (!cycle.update(problem.system.matrix, problem.system.pinned))
    return state.SkipWithError("the matrix is not definite");
  NodeVector<double> r, z(4 * problem.mesh.nodes.size(), 0);
  pack(problem.system.load, r);
  for (auto _ : state) {
    cycle.apply(r, 1.0, z);
    benchmark::DoNotOptimize(z.data());
  }
  const std::int64_t blocks = problem.fine.pattern.blocks();
  report(state, "per_block", blocks, 120 * blocks);
}

BENCHMARK_CAPTURE(run, v, CycleKind::V)->Apply(table_2_sizes);
BENCHMARK_CAPTURE(run, w, CycleKind::W)->Apply(table_2_sizes);

}  // namespace
}  // namespace softreel::kernels
