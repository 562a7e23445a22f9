/// What a cycle asks of a smoother, and what all smoothers share: the inverted diagonal blocks.
///
/// Smoothing before and after the coarse correction are each other's adjoints in the inner product of A, so that the
/// cycle is a symmetric operator.
#pragma once

#include <cstdint>
#include <memory>
#include <type_traits>

#include "core/base/parallel.h"
#include "core/multigrid/lattice_hierarchy.h"
#include "core/sparse/block_kernels.h"
#include "core/sparse/row_product_simd.h"

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
  /// The rows of a level by plain pointers, for the inner loops.
  struct Rows {
    explicit Rows(const Smoother& smoother)
        : values(smoother.matrix_.values.data()),
          columns(smoother.level_.pattern.column_indices.data()),
          offsets(smoother.level_.pattern.row_offsets.data()),
          diagonal(smoother.level_.diagonal.data()),
          inverse(smoother.inverses_.data()) {}

    [[gnu::always_inline]] NodeLanes<Scalar> left_sum(std::int64_t i, const Scalar* x) const {
      return sum(offsets[i], diagonal[i], x);
    }
    [[gnu::always_inline]] NodeLanes<Scalar> right_sum(std::int64_t i, const Scalar* x) const {
      return sum(diagonal[i] + 1, offsets[i + 1], x);
    }
    [[gnu::always_inline]] NodeLanes<Scalar> rest_sum(std::int64_t i, const Scalar* x) const {
      return sum(diagonal[i], offsets[i + 1], x);
    }
    [[gnu::always_inline]] NodeLanes<Scalar> full_sum(std::int64_t i, const Scalar* x) const {
      return sum(offsets[i], offsets[i + 1], x);
    }
    [[gnu::always_inline]] NodeLanes<Scalar> sum(std::int64_t begin, std::int64_t end, const Scalar* x) const {
      if constexpr (std::is_same_v<Scalar, float>)
        return paired_row_product(values, columns, begin, end, x);
      else
        return column_major_row_product(values, columns, begin, end, x);
    }
    /// The fourth lane of the result is 0 whatever that of rhs.
    [[gnu::always_inline]] NodeLanes<Scalar> solve_diagonal(std::int64_t i, const NodeLanes<Scalar>& rhs) const {
      using Column = Eigen::Map<const NodeLanes<Scalar>>;
      const Scalar* const column = inverse + 12 * i;
      return Column(column) * rhs[0] + (Column(column + 4) * rhs[1] + Column(column + 8) * rhs[2]);
    }

    const Scalar* values;
    const Index* columns;
    const std::int64_t* offsets;
    const std::int64_t* diagonal;
    const Scalar* inverse;
  };

  const LatticeLevel& level_;
  const BlockMatrix<Scalar>& matrix_;
  AlignedVector<Scalar> inverses_;  ///< of the diagonal blocks: 3 columns of 4 lanes each, the fourth 0
};

/// The smoother that params.smoother names. Both references are kept.
template <typename Scalar>
std::unique_ptr<Smoother<Scalar>> make_smoother(const MultigridParams& params, const LatticeLevel& level,
                                                const BlockMatrix<Scalar>& matrix);

}  // namespace softreel
