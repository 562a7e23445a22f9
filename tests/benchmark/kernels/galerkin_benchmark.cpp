/// R K R^T from the finest level in float: eq. (9) as written, the paper's stream, and the gather of the solver.
///
/// Bound: a block of K is 36 bytes; the gather reads half of them and 8 bytes of plan for each of its products.
/// Measured / bound at 64k tetrahedra and 25 GB/s of L3, one core: gather 2.8 / 1.6 ns (1.7), stream
/// 5.8 / 2.8 (2.0), naive 146.
#include "core/sparse/galerkin_gather.h"
#include "core/sparse/galerkin_product.h"
#include "core/sparse/galerkin_stream.h"
#include "tests/benchmark/kernels/kernel_problem.h"

namespace softreel::kernels {
namespace {

void run(benchmark::State& state, GalerkinMethod method) {
  Problem problem(state.range(0));
  const LatticeLevel& level = problem.hierarchy.levels[0];
  BlockMatrixf E{problem.hierarchy.levels[1].pattern, {}};
  reserve_values(E);
  const GalerkinStream<float> stream(level.pattern, level.prolongation, E.pattern);
  const GalerkinGather<float> gather(level.pattern, level.prolongation, E.pattern, level.rank);
  for (auto _ : state) {
    if (method == GalerkinMethod::Naive) galerkin_product(problem.fine, level.restriction, E);
    if (method == GalerkinMethod::Stream) stream.run(problem.fine, E);
    if (method == GalerkinMethod::Gather) gather.run(problem.fine, E, problem.threads);
    benchmark::DoNotOptimize(E.values.data());
  }
  const std::int64_t blocks = level.pattern.blocks(), written = 36 * E.pattern.blocks();
  const std::int64_t read = method == GalerkinMethod::Gather   ? 18 * blocks + gather.bytes()
                            : method == GalerkinMethod::Stream ? 36 * blocks + stream.bytes()
                                                               : 40 * blocks;
  report(state, "per_block", blocks, read + written);
}

BENCHMARK_CAPTURE(run, naive, GalerkinMethod::Naive)->Apply(table_2_sizes);
BENCHMARK_CAPTURE(run, stream, GalerkinMethod::Stream)->Apply(table_2_sizes);
BENCHMARK_CAPTURE(run, gather, GalerkinMethod::Gather)->Apply(table_2_sizes);

}  // namespace
}  // namespace softreel::kernels
