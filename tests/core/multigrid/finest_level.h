/// The finest level of a small clamped box, in double, and vectors on it.
#pragma once

#include <algorithm>
#include <random>

#include "core/multigrid/lattice_hierarchy.h"
#include "core/sparse/block_kernels.h"
#include "tests/support/elastic_box.h"

namespace softreel::test_support {

inline NodeVector<double> random_vector(Index nodes, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1, 1);
  NodeVector<double> vector(static_cast<std::size_t>(4 * nodes), 0);
  for (std::size_t k = 0; k < vector.size(); ++k)
    if (k % 4 < 3) vector[k] = value(random);
  return vector;
}

struct Finest {
  Finest()
      : mesh(make_box({4, 3, 3}, 0.5)),
        system(assemble(mesh, {}, [](const Vec3& x) { return x[0] < 1e-9; })),
        hierarchy(build_lattice_hierarchy(mesh, {}, system.matrix.pattern, {})) {
    matrix.pattern = hierarchy.levels[0].pattern;
    reserve_values(matrix);
    for (std::size_t b = 0; b < hierarchy.source_blocks.size(); ++b)
      std::copy_n(system.matrix.block(hierarchy.source_blocks[b]), 9, matrix.values.data() + 9 * b);
  }
  TetMesh mesh;
  ElasticSystem system;
  LatticeHierarchy hierarchy;
  BlockMatrixd matrix;
};

}  // namespace softreel::test_support
