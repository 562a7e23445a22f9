/// Direct solver of the coarsest level: Cholesky in double within the envelope of the matrix.
///
/// Rows are ordered by reverse Cuthill-McKee (Cuthill and McKee 1969; George 1971); fill stays between the first entry
/// of a row and its diagonal. For a bottom of 40 to 150 nodes the factors stay in cache.
#pragma once

#include <cstdint>
#include <vector>

#include "core/sparse/block_kernels.h"
#include "core/sparse/block_matrix.h"

namespace softreel {

/// The place of each row in an order of all of them.
std::vector<Index> inverted(const std::vector<Index>& order);

/// Multiply-adds that factoring a matrix of this pattern takes.
double factor_work(const BlockPattern& pattern);

class CoarseSolver {
 public:
  explicit CoarseSolver(const BlockPattern& pattern);

  /// Factors a matrix with the constructor's pattern, symmetric, positive semidefinite, blocks column-major. A pivot
  /// that cancellation has brought below `noise` times its diagonal entry marks an unknown that depends on those before
  /// it: it is left at 0. False if the matrix is not positive semidefinite or not finite.
  template <typename Scalar>
  bool factor(const BlockMatrix<Scalar>& matrix, double noise);

  /// x = A^-1 b.
  template <typename Scalar>
  void solve(const NodeVector<Scalar>& b, NodeVector<Scalar>& x);

  std::int64_t bytes() const;

 private:
  double* row(std::size_t i) { return factor_.data() + (row_offsets_[i] - first_[i]); }
  /// The three rows of the node at place p; false if a pivot says that the matrix is not semidefinite.
  bool factor_node(std::size_t p, double noise);
  /// Row i of the node whose rows start at `done`; columns before that are factored.
  bool factor_diagonal(std::size_t i, std::size_t done, double noise);

  std::vector<Index> place_;               ///< of each node in the elimination order
  std::vector<Index> first_;               ///< first column of each scalar row's envelope
  std::vector<std::int64_t> row_offsets_;  ///< of each scalar row in factor_
  AlignedVector<double> factor_;           ///< rows of L from first_ to the diagonal
  std::vector<double> inverse_pivots_;     ///< 1 / L_ii; 0 for an unknown that is left out
  std::vector<double> work_;
};

}  // namespace softreel
