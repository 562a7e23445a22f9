/// Block-row-compressed sparse matrix of 3x3 blocks (the paper's BRC format, sec. 4.1).
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/aligned.h"
#include "core/base/types.h"

namespace softreel {

/// Where the blocks are: row i owns the blocks [row_offsets[i], row_offsets[i + 1]); columns ascend within a row.
/// Patterns are symmetric and hold every diagonal block.
struct BlockPattern {
  Index columns = 0;
  std::vector<std::int64_t> row_offsets{0};
  std::vector<Index> column_indices;

  Index rows() const { return static_cast<Index>(row_offsets.size()) - 1; }
  std::int64_t blocks() const { return static_cast<std::int64_t>(column_indices.size()); }
  /// Position of block (row, column) by binary search; -1 if it is not in the pattern.
  std::int64_t find(Index row, Index column) const;
};

/// A pattern with values; block b is values[9 b .. 9 b + 8], row-major. The pattern is shared by value on purpose:
/// copy it once, then only the values change.
template <typename Scalar>
struct BlockMatrix {
  BlockPattern pattern;
  AlignedVector<Scalar> values;

  Scalar* block(std::int64_t b) { return values.data() + 9 * b; }
  const Scalar* block(std::int64_t b) const { return values.data() + 9 * b; }
};

using BlockMatrixd = BlockMatrix<double>;
using BlockMatrixf = BlockMatrix<float>;

/// Pattern of the stiffness matrix of a mesh: node i and j share a block if an element has both.
BlockPattern stiffness_pattern(const std::vector<Tet>& tets, Index nodes);

}  // namespace softreel
