#include "tests/benchmark/rivals/rival.h"

#include <algorithm>

namespace softreel::rivals {

int Rival::solve_from(const Eigen::VectorXd&, double tolerance, Eigen::VectorXd& x) {
  return solve(tolerance, x);
}

ScalarSystem make_scalar_system(const benchmark_support::LinearSystem& system, std::span<const Vec3> rest_positions) {
  ScalarSystem scalar;
  std::vector<Index> number(system.pinned.size(), -1);
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (system.pinned[i] != 0) continue;
    number[i] = static_cast<Index>(scalar.mesh_nodes.size());
    scalar.mesh_nodes.push_back(static_cast<Index>(i));
    scalar.positions.push_back(rest_positions[i]);
  }
  const auto unknowns = 3 * static_cast<Index>(scalar.mesh_nodes.size());
  const BlockPattern& pattern = system.matrix.pattern;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(9 * pattern.blocks()));
  scalar.load.resize(unknowns);
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    scalar.load.segment<3>(3 * number[i]) = system.load[i];
    for (std::int64_t b = pattern.row_offsets[i]; b < pattern.row_offsets[i + 1]; ++b) {
      const Index column = number[static_cast<std::size_t>(pattern.column_indices[static_cast<std::size_t>(b)])];
      if (column < 0) continue;
      for (Index k = 0; k < 9; ++k)
        entries.emplace_back(3 * number[i] + k / 3, 3 * column + k % 3, system.matrix.block(b)[k]);
    }
  }
  scalar.matrix.resize(unknowns, unknowns);
  scalar.matrix.setFromTriplets(entries.begin(), entries.end());
  return scalar;
}

void take_values(const benchmark_support::LinearSystem& system, ScalarSystem& scalar) {
  const BlockPattern& pattern = system.matrix.pattern;
  double* value = scalar.matrix.valuePtr();
  for (std::size_t k = 0; k < scalar.mesh_nodes.size(); ++k) {
    const auto i = static_cast<std::size_t>(scalar.mesh_nodes[k]);
    scalar.load.segment<3>(3 * static_cast<Eigen::Index>(k)) = system.load[i];
    // The matrix is symmetric: the columns of node i are its rows.
    for (int c = 0; c < 3; ++c)
      for (std::int64_t b = pattern.row_offsets[i]; b < pattern.row_offsets[i + 1]; ++b) {
        const Index column = pattern.column_indices[static_cast<std::size_t>(b)];
        if (system.pinned[static_cast<std::size_t>(column)] == 0)
          value = std::copy_n(system.matrix.block(b) + 3 * c, 3, value);
      }
  }
}

}  // namespace softreel::rivals
