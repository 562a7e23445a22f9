#include "core/sparse/weight_matrix.h"

#include <algorithm>

namespace softreel {

WeightMatrix transpose(const WeightMatrix& matrix) {
  WeightMatrix result;
  result.columns = matrix.rows();
  result.row_offsets.assign(static_cast<std::size_t>(matrix.columns) + 1, 0);
  for (const Index column : matrix.column_indices) ++result.row_offsets[static_cast<std::size_t>(column) + 1];
  for (std::size_t i = 1; i < result.row_offsets.size(); ++i) result.row_offsets[i] += result.row_offsets[i - 1];
  result.column_indices.resize(matrix.column_indices.size());
  result.weights.resize(matrix.weights.size());
  std::vector<std::int64_t> next(result.row_offsets.begin(), result.row_offsets.end() - 1);
  for (Index row = 0; row < matrix.rows(); ++row) {
    const auto r = static_cast<std::size_t>(row);
    for (std::int64_t entry = matrix.row_offsets[r]; entry < matrix.row_offsets[r + 1]; ++entry) {
      const auto from = static_cast<std::size_t>(entry);
      const auto to = static_cast<std::size_t>(next[static_cast<std::size_t>(matrix.column_indices[from])]++);
      result.column_indices[to] = row;
      result.weights[to] = matrix.weights[from];
    }
  }
  return result;
}

BlockPattern galerkin_pattern(const BlockPattern& K, const WeightMatrix& R, const WeightMatrix& R_transposed) {
  BlockPattern pattern;
  pattern.columns = R.rows();
  std::vector<Index> last_row(static_cast<std::size_t>(R.rows()), -1), row;
  for (Index i = 0; i < R.rows(); ++i) {
    row.clear();
    const auto r = static_cast<std::size_t>(i);
    for (std::int64_t a = R.row_offsets[r]; a < R.row_offsets[r + 1]; ++a) {
      const auto l = static_cast<std::size_t>(R.column_indices[static_cast<std::size_t>(a)]);
      for (std::int64_t b = K.row_offsets[l]; b < K.row_offsets[l + 1]; ++b) {
        const auto k = static_cast<std::size_t>(K.column_indices[static_cast<std::size_t>(b)]);
        for (std::int64_t c = R_transposed.row_offsets[k]; c < R_transposed.row_offsets[k + 1]; ++c) {
          const Index j = R_transposed.column_indices[static_cast<std::size_t>(c)];
          if (last_row[static_cast<std::size_t>(j)] == i) continue;
          last_row[static_cast<std::size_t>(j)] = i;
          row.push_back(j);
        }
      }
    }
    std::sort(row.begin(), row.end());
    pattern.column_indices.insert(pattern.column_indices.end(), row.begin(), row.end());
    pattern.row_offsets.push_back(pattern.blocks());
  }
  return pattern;
}

}  // namespace softreel
