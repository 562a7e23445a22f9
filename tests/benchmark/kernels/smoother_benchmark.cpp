/// One smoothing from zero with its residual, and one from a given x, on the finest level in float.
///
/// Bound: 40 bytes for each block read; symmetric Gauss-Seidel reads the matrix 1.5 + 1.5 times, one-way 1 + 1 times,
/// Chebyshev of degree 2 2 + 2 times.
/// Measured / bound at 64k tetrahedra and 25 GB/s of L3, one core: 6.2 / 4.8 ns (1.3), one-way
/// 3.8 / 3.2 (1.2), Chebyshev 8.6 / 6.4 (1.4).
#include "core/multigrid/smoother.h"
#include "tests/benchmark/kernels/kernel_problem.h"

namespace softreel::kernels {
namespace {

void run(benchmark::State& state, SmootherKind kind, std::int64_t half_reads) {
  Problem problem(state.range(0));
  MultigridParams params;
  params.smoother = kind;
  const auto smoother = make_smoother<float>(params, problem.hierarchy.levels[0], problem.fine);
  if (!smoother->update(problem.threads)) return state.SkipWithError("the matrix is not definite");
  const std::size_t size = 4 * problem.mesh.nodes.size();
  NodeVector<float> b(size, 0), x(size, 0), r(size, 0);
  for (std::size_t k = 0; k < size; ++k) b[k] = k % 4 < 3 ? static_cast<float>(k % 7) : 0;
  for (auto _ : state) {
    smoother->smooth_from_zero(1, b, x, r, problem.threads);
    smoother->smooth(1, b, x, problem.threads);
    benchmark::DoNotOptimize(x.data());
  }
  const std::int64_t blocks = problem.fine.pattern.blocks();
  report(state, "per_block", blocks, 20 * half_reads * blocks);
}

BENCHMARK_CAPTURE(run, gauss_seidel, SmootherKind::GaussSeidel, 6)->Apply(table_2_sizes);
BENCHMARK_CAPTURE(run, one_way_gauss_seidel, SmootherKind::OneWayGaussSeidel, 4)->Apply(table_2_sizes);
BENCHMARK_CAPTURE(run, chebyshev, SmootherKind::Chebyshev, 8)->Apply(table_2_sizes);

}  // namespace
}  // namespace softreel::kernels
