/// What the kernel benchmarks work on: bars of the sizes of the paper's Table 2, and how they report.
///
/// Counters: processor time per tetrahedron or block on one thread, and the bytes that the kernel must move at least
/// for each, to be held against the machine's bandwidth (targets, before section 1).
#pragma once

#include <vector>

#include <benchmark/benchmark.h>

#include "core/multigrid/lattice_hierarchy.h"
#include "core/multigrid/multigrid.h"
#include "tests/benchmark/bar_problem.h"
#include "tests/support/elastic_box.h"

namespace softreel::kernels {

/// Cubes across of bars of 11k, 37k and 67k tetrahedra.
inline void table_2_sizes(benchmark::internal::Benchmark* b) {
  for (const int across : {6, 9, 11}) b->Arg(across);
}

/// The bar of the targets, deformed, as a dynamic system with its hierarchy.
struct Problem {
  explicit Problem(std::int64_t across)
      : threads(1),
        mesh(test_support::make_bar(static_cast<Index>(across))),
        materials(mesh.tets.size(), benchmark_support::kBarMaterial),
        positions(benchmark_support::deform_bar(mesh.nodes, mesh.lattice.spacing)),
        system(make_system(mesh, materials, positions, benchmark_support::SystemKind::Dynamic, threads)),
        hierarchy(build_lattice_hierarchy(mesh, {}, system.matrix.pattern, {})) {
    fine.pattern = hierarchy.levels[0].pattern;
    reserve_values(fine);
    for (std::size_t b = 0; b < hierarchy.source_blocks.size(); ++b)
      for (std::size_t k = 0; k < 9; ++k)
        fine.values[9 * b + k] = static_cast<float>(system.matrix.block(hierarchy.source_blocks[b])[k]);
  }
  Threads threads;
  TetMesh mesh;
  std::vector<ElementMaterial> materials;
  std::vector<Vec3> positions;
  benchmark_support::LinearSystem system;
  LatticeHierarchy hierarchy;
  BlockMatrixf fine;  ///< level 0 as the cycle stores it
};

/// Time for each of `items` a run, and the bandwidth if a run moves `bytes`.
inline void report(benchmark::State& state, const char* unit, std::int64_t items, std::int64_t bytes) {
  const auto runs = static_cast<double>(state.iterations());
  using benchmark::Counter;
  state.counters[unit] = Counter(runs * static_cast<double>(items), Counter::kIsRate | Counter::kInvert);
  state.counters["bytes"] = static_cast<double>(bytes) / static_cast<double>(items);
  state.SetBytesProcessed(state.iterations() * bytes);
}

}  // namespace softreel::kernels
