#include "tests/benchmark/rivals/rival.h"

namespace softreel::rivals {

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

}  // namespace softreel::rivals
