/// Symmetric block Gauss-Seidel over colours: forward, then backward.
///
/// Rows of one colour share no block, so they are updated in parallel with the same bits at any thread count. A row's
/// blocks left of the diagonal belong to earlier colours. Two facts save reads of the matrix, which are the cost:
/// - going backward, the sum over the left half is the one that the forward sweep computed last, so it is kept;
/// - after the backward sweep b - A x = s - L x for the kept sums s and the strictly left half L.
/// Bound: a smoothing from zero with its residual reads the matrix 1.5 times, one from a given x 1.5 times.
#pragma once

#include "core/base/parallel.h"
#include "core/multigrid/lattice_hierarchy.h"
#include "core/sparse/block_kernels.h"

namespace softreel {

template <typename Scalar>
class Smoother {
 public:
  /// Both are kept by reference. The blocks are column-major, the values from reserve_values.
  Smoother(const LatticeLevel& level, const BlockMatrix<Scalar>& matrix);

  /// Inverts the diagonal blocks; false if one is not positive definite in this precision.
  bool update(const Threads& threads);

  /// x = result of `sweeps` symmetric sweeps for A x = b from x = 0; r = b - A x. sweeps: at least 1.
  void smooth_from_zero(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                        const Threads& threads);

  /// `sweeps` symmetric sweeps from x.
  void smooth(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads);

  /// r = b - A x.
  void find_residual(const NodeVector<Scalar>& b, const NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                     const Threads& threads) const;

  /// The same right after a smoothing of x for b, from what its sweeps kept: half the reads.
  void find_swept_residual(const NodeVector<Scalar>& x, NodeVector<Scalar>& r, const Threads& threads) const;

  std::int64_t bytes() const;

 private:
  template <typename RowUpdate>
  void for_color(std::size_t color, const Threads& threads, const RowUpdate& update) const;
  void forward_from_zero(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads);
  void forward(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads);
  void backward(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads);

  const LatticeLevel& level_;
  const BlockMatrix<Scalar>& matrix_;
  AlignedVector<Scalar> inverses_;  ///< of the diagonal blocks: 3 columns of 4 lanes each, the fourth 0
  NodeVector<Scalar> left_sums_;    ///< of the last forward sweep
};

}  // namespace softreel
