/// y = A x of 3x3 blocks, in double and in float.
///
/// Bound: 76 bytes a block in double, 40 in float.
/// Measured / bound at 64k tetrahedra and 25 GB/s of L3, one core: double 2.4 / 3.0 ns, float
/// 1.5 / 1.6 ns: part of it comes from L2.
#include "core/sparse/block_kernels.h"
#include "tests/benchmark/kernels/kernel_problem.h"

namespace softreel::kernels {
namespace {

template <typename Scalar>
void run(benchmark::State& state, const Problem& problem, const BlockMatrix<Scalar>& A) {
  NodeVector<Scalar> x(4 * problem.mesh.nodes.size(), 0), y = x;
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = k % 4 < 3 ? static_cast<Scalar>(k % 7) : 0;
  for (auto _ : state) {
    multiply(A, x, y, problem.threads);
    benchmark::DoNotOptimize(y.data());
  }
  const std::int64_t blocks = A.pattern.blocks();
  report(state, "per_block", blocks, blocks * static_cast<std::int64_t>(9 * sizeof(Scalar) + sizeof(Index)));
}

void in_double(benchmark::State& state) {
  const Problem problem(state.range(0));
  run(state, problem, problem.system.matrix);
}
void in_float(benchmark::State& state) {
  const Problem problem(state.range(0));
  run(state, problem, problem.fine);
}

BENCHMARK(in_double)->Name("block_product/double")->Apply(table_2_sizes);
BENCHMARK(in_float)->Name("block_product/float")->Apply(table_2_sizes);

}  // namespace
}  // namespace softreel::kernels
