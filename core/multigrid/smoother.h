/// What a cycle asks of a smoother, and what all smoothers share: the inverted diagonal blocks.
///
/// Smoothing before and after the coarse correction are each other's adjoints in the inner product of A, so that the
/// cycle is a symmetric operator.
#pragma once

#include <cstdint>
#include <memory>

#include "core/base/parallel.h"
#include "core/multigrid/lattice_hierarchy.h"
#include "core/sparse/block_kernels.h"

namespace softreel {

template <typename Scalar>
class Smoother {
 public:
  /// Both are kept by reference. The blocks are column-major, the values from reserve_values.
  Smoother(const LatticeLevel& level, const BlockMatrix<Scalar>& matrix);
  virtual ~Smoother() = default;
  Smoother(const Smoother&) = delete;
  Smoother& operator=(const Smoother&) = delete;

  /// Takes the matrix's values; false if a diagonal block is not positive definite in this precision.
  virtual bool update(const Threads& threads);

  /// Before the correction: x = result of `sweeps` sweeps for A x = b from x = 0; r = b - A x. sweeps: at least 1.
  virtual void smooth_from_zero(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                                const Threads& threads) = 0;

  /// After it: `sweeps` sweeps from x.
  virtual void smooth(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) = 0;

  /// r = b - A x.
  void find_residual(const NodeVector<Scalar>& b, const NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                     const Threads& threads) const;

  /// The same right after `smooth` of x for b, from what that kept where it kept something.
  virtual void find_smoothed_residual(const NodeVector<Scalar>& b, const NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                                      const Threads& threads) const {
    find_residual(b, x, r, threads);
  }

  virtual std::int64_t bytes() const { return static_cast<std::int64_t>(inverses_.size() * sizeof(Scalar)); }

 protected:
  /// The rows of a level, for the inner loops: core/multigrid/smoother_rows.h.
  struct Rows;

  const LatticeLevel& level_;
  const BlockMatrix<Scalar>& matrix_;
  AlignedVector<Scalar> inverses_;  ///< of the diagonal blocks: 3 columns of 4 lanes each, the fourth 0
};

/// The smoother that params.smoother names. Both references are kept.
template <typename Scalar>
std::unique_ptr<Smoother<Scalar>> make_smoother(const MultigridParams& params, const LatticeLevel& level,
                                                const BlockMatrix<Scalar>& matrix);

}  // namespace softreel
