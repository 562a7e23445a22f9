/// The matrix of a time step in float from given rotations: the elements' terms, then the gather into blocks.
///
/// Bound: 330 bytes a tetrahedron for the terms; 64 of gradients and 2.7 blocks of 36 bytes for the gather.
/// Measured / bound at 64k tetrahedra and 25 GB/s of L3, one core: 69 / 20 ns (3.5; 47 ns at 10k).
#include "core/elasticity/float_assembly.h"
#include "core/elasticity/step_terms.h"
#include "tests/benchmark/kernels/kernel_problem.h"

namespace softreel::kernels {
namespace {

void assemble(benchmark::State& state) {
  Problem problem(state.range(0));
  const ElasticBody body = make_elastic_body(problem.mesh, problem.materials, Dilatation::Capped);
  std::vector<Quaternion> rotations(problem.mesh.tets.size(), Quaternion::Identity());
  find_rotations(body, RotationMethod::Consistent, problem.positions, rotations, problem.threads);
  const std::vector<Vec3> velocities(problem.mesh.nodes.size(), Vec3::Zero());
  const std::vector<double> damping(problem.mesh.tets.size(), benchmark_support::kBarMaterial.damping_stiffness);
  const std::vector<double> node_terms(problem.mesh.nodes.size(), 1e-3);
  std::vector<Index> row_of_node(problem.mesh.nodes.size());
  for (std::size_t row = 0; row < row_of_node.size(); ++row)
    row_of_node[static_cast<std::size_t>(problem.hierarchy.mesh_nodes[row])] = static_cast<Index>(row);
  const FloatAssembler assembler(problem.mesh.tets, body.node_elements, problem.fine.pattern, row_of_node);
  const StepSeconds seconds{benchmark_support::kBarStep, benchmark_support::kBarStep};
  StepTerms terms;
  for (auto _ : state) {
    find_step_terms(body, {problem.positions, velocities, rotations, seconds, damping, {}}, terms, problem.threads);
    assembler.assemble(terms, node_terms, {}, problem.fine, problem.threads);
    benchmark::DoNotOptimize(problem.fine.values.data());
  }
  const auto tets = static_cast<std::int64_t>(problem.mesh.tets.size());
  report(state, "per_tet", tets, 394 * tets + 36 * problem.fine.pattern.blocks());
}

BENCHMARK(assemble)->Apply(table_2_sizes);

}  // namespace
}  // namespace softreel::kernels
