/// Sparse matrix of scalar weights between the nodes of two levels: the restriction R of eq. (9) and its transpose.
///
/// A weight w stands for the 3x3 block w I. Both R and its transpose are kept by those who need them: a transposed
/// product would scatter, which neither runs in parallel nor sums in a fixed order.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/types.h"
#include "core/sparse/block_matrix.h"

namespace softreel {

/// Row-compressed; columns ascend within a row.
struct WeightMatrix {
  Index columns = 0;
  std::vector<std::int64_t> row_offsets{0};
  std::vector<Index> column_indices;
  std::vector<double> weights;

  Index rows() const { return static_cast<Index>(row_offsets.size()) - 1; }
  std::int64_t entries() const { return static_cast<std::int64_t>(column_indices.size()); }
};

WeightMatrix transpose(const WeightMatrix& matrix);

/// Pattern of E = R K R^T: block (i, j) exists if R_il, K_lk and R_jk do for some l, k. Symmetric if K's is, and holds
/// the diagonal if K's does.
BlockPattern galerkin_pattern(const BlockPattern& K, const WeightMatrix& R, const WeightMatrix& R_transposed);

}  // namespace softreel
