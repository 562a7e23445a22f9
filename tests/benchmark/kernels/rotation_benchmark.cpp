/// Element rotations of a deformed bar from the rotations before: the default method (consistent) and eq. (3).
///
/// Bound: 128 bytes of rest shape and 32 + 32 of rotation a tetrahedron; arithmetic decides (targets, section 1).
/// Measured / bound at 64k tetrahedra and 25 GB/s of L3, one core: 17 / 7.7 ns (2.2); by eq. (3) 86 ns.
#include "core/elasticity/elastic_body.h"
#include "tests/benchmark/kernels/kernel_problem.h"

namespace softreel::kernels {
namespace {

void run(benchmark::State& state, RotationMethod method) {
  const Problem problem(state.range(0));
  const ElasticBody body = make_elastic_body(problem.mesh, problem.materials, Dilatation::Capped);
  std::vector<Quaternion> rotations(problem.mesh.tets.size(), Quaternion::Identity());
  for (auto _ : state) {
    find_rotations(body, method, problem.positions, rotations, problem.threads);
    benchmark::DoNotOptimize(rotations.data());
  }
  const auto tets = static_cast<std::int64_t>(problem.mesh.tets.size());
  report(state, "per_tet", tets, 192 * tets);
}

BENCHMARK_CAPTURE(run, consistent, RotationMethod::Consistent)->Apply(table_2_sizes);
BENCHMARK_CAPTURE(run, energy, RotationMethod::Energy)->Apply(table_2_sizes);

}  // namespace
}  // namespace softreel::kernels
