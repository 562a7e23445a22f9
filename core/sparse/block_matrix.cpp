#include "core/sparse/block_matrix.h"

#include <algorithm>

namespace softreel {

std::int64_t BlockPattern::find(Index row, Index column) const {
  const Index* const columns_begin = column_indices.data();
  const Index* const begin = columns_begin + row_offsets[static_cast<std::size_t>(row)];
  const Index* const end = columns_begin + row_offsets[static_cast<std::size_t>(row) + 1];
  const Index* const found = std::lower_bound(begin, end, column);
  return found != end && *found == column ? found - columns_begin : -1;
}

BlockPattern stiffness_pattern(const std::vector<Tet>& tets, Index nodes) {
  // Elements of each node by counting; then each row collects the nodes of its elements.
  const auto n = static_cast<std::size_t>(nodes);
  std::vector<std::int64_t> offsets(n + 1, 0);
  for (const Tet& tet : tets)
    for (const Index node : tet) ++offsets[static_cast<std::size_t>(node) + 1];
  for (std::size_t i = 0; i < n; ++i) offsets[i + 1] += offsets[i];
  std::vector<std::size_t> owners(4 * tets.size());
  std::vector<std::int64_t> next(offsets.begin(), offsets.end() - 1);
  for (std::size_t e = 0; e < tets.size(); ++e)
    for (const Index node : tets[e]) owners[static_cast<std::size_t>(next[static_cast<std::size_t>(node)]++)] = e;

  BlockPattern pattern;
  pattern.columns = nodes;
  pattern.row_offsets.reserve(n + 1);
  std::vector<Index> row;
  for (std::size_t i = 0; i < n; ++i) {
    row.assign(1, static_cast<Index>(i));
    for (std::int64_t o = offsets[i]; o < offsets[i + 1]; ++o) {
      const Tet& tet = tets[owners[static_cast<std::size_t>(o)]];
      row.insert(row.end(), tet.begin(), tet.end());
    }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    pattern.column_indices.insert(pattern.column_indices.end(), row.begin(), row.end());
    pattern.row_offsets.push_back(pattern.blocks());
  }
  return pattern;
}

}  // namespace softreel
