#include "core/multigrid/smoother.h"

#include <cmath>
#include <type_traits>

#include "core/base/check.h"
#include "core/sparse/row_product_simd.h"

namespace softreel {
namespace {

/// A block counts as positive definite if its determinant is this share of the product of its diagonal: above the
/// rounding of the cofactors.
constexpr double kLeastDeterminant = 1e-14;

/// The rows of a level by plain pointers, for the inner loops.
template <typename Scalar>
struct Rows {
  Rows(const LatticeLevel& level, const BlockMatrix<Scalar>& matrix, const AlignedVector<Scalar>& inverses)
      : values(matrix.values.data()),
        columns(level.pattern.column_indices.data()),
        offsets(level.pattern.row_offsets.data()),
        diagonal(level.diagonal.data()),
        inverse(inverses.data()) {}

  [[gnu::always_inline]] NodeLanes<Scalar> left_sum(std::int64_t i, const Scalar* x) const {
    return sum(offsets[i], diagonal[i], x);
  }
  [[gnu::always_inline]] NodeLanes<Scalar> right_sum(std::int64_t i, const Scalar* x) const {
    return sum(diagonal[i] + 1, offsets[i + 1], x);
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

/// Inverse of a symmetric 3x3 block by cofactors, in double, as 3 columns of 4 lanes; false, and nothing stored, if the
/// block is not positive definite.
template <typename Scalar>
bool invert(const Scalar* block, Scalar* inverse) {
  const auto at = [&](int k) { return static_cast<double>(block[k]); };
  const double a = at(0), b = 0.5 * (at(1) + at(3)), c = 0.5 * (at(2) + at(6)), d = at(4), e = 0.5 * (at(5) + at(7)),
               f = at(8);
  const double c00 = d * f - e * e, c01 = c * e - b * f, c02 = b * e - c * d;
  const double c11 = a * f - c * c, c12 = b * c - a * e, c22 = a * d - b * b;
  const double determinant = a * c00 + b * c01 + c * c02;
  // Cofactors cancel where the block is nearly singular: then the sign of the determinant means nothing.
  if (!(a > 0 && c22 > 0 && determinant > kLeastDeterminant * (a * d) * f) || !std::isfinite(determinant)) return false;
  const double scale = 1 / determinant;
  const double entries[9] = {c00, c01, c02, c01, c11, c12, c02, c12, c22};
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      inverse[4 * column + row] = static_cast<Scalar>(entries[3 * column + row] * scale);
  return true;
}

}  // namespace

template <typename Scalar>
Smoother<Scalar>::Smoother(const LatticeLevel& level, const BlockMatrix<Scalar>& matrix)
    : level_(level), matrix_(matrix) {
  const auto rows = static_cast<std::size_t>(level.pattern.rows());
  inverses_.assign(12 * rows, Scalar{0});
  left_sums_.assign(4 * rows, Scalar{0});
}

template <typename Scalar>
bool Smoother<Scalar>::update(const Threads& threads) {
  const double failures =
      threads.sum_chunks(level_.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
        double failed = 0;
        for (std::int64_t i = begin; i < end; ++i)
          if (!invert(matrix_.block(level_.diagonal[static_cast<std::size_t>(i)]), inverses_.data() + 12 * i)) ++failed;
        return failed;
      });
  return failures == 0;
}

template <typename Scalar>
template <typename RowUpdate>
void Smoother<Scalar>::for_color(std::size_t color, const Threads& threads, const RowUpdate& update) const {
  const std::int64_t first = level_.color_offsets[color], count = level_.color_offsets[color + 1] - first;
  threads.for_chunks(count, kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = first + begin; i < first + end; ++i) update(i);
  });
}

template <typename Scalar>
void Smoother<Scalar>::forward_from_zero(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) {
  const Rows<Scalar> rows(level_, matrix_, inverses_);
  for (std::size_t color = 0; color + 1 < level_.color_offsets.size(); ++color)
    for_color(color, threads, [&](std::int64_t i) {
      const NodeLanes<Scalar> left = rows.left_sum(i, x.data());
      lanes(left_sums_, i) = left;
      lanes(x, i) = rows.solve_diagonal(i, lanes(b, i) - left);
    });
}

template <typename Scalar>
void Smoother<Scalar>::forward(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) {
  const Rows<Scalar> rows(level_, matrix_, inverses_);
  for (std::size_t color = 0; color + 1 < level_.color_offsets.size(); ++color)
    for_color(color, threads, [&](std::int64_t i) {
      const NodeLanes<Scalar> left = rows.left_sum(i, x.data());
      lanes(left_sums_, i) = left;
      lanes(x, i) = rows.solve_diagonal(i, lanes(b, i) - left - rows.right_sum(i, x.data()));
    });
}

template <typename Scalar>
void Smoother<Scalar>::backward(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) {
  const Rows<Scalar> rows(level_, matrix_, inverses_);
  for (std::size_t color = level_.color_offsets.size() - 1; color-- > 0;)
    for_color(color, threads, [&](std::int64_t i) {
      lanes(x, i) = rows.solve_diagonal(i, lanes(b, i) - lanes(left_sums_, i) - rows.right_sum(i, x.data()));
    });
}

template <typename Scalar>
void Smoother<Scalar>::smooth_from_zero(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x,
                                        NodeVector<Scalar>& r, const Threads& threads) {
  CHECK(sweeps >= 1);
  forward_from_zero(b, x, threads);
  backward(b, x, threads);
  smooth(sweeps - 1, b, x, threads);
  find_swept_residual(x, r, threads);
}

template <typename Scalar>
void Smoother<Scalar>::smooth(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) {
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    forward(b, x, threads);
    backward(b, x, threads);
  }
}

template <typename Scalar>
void Smoother<Scalar>::find_residual(const NodeVector<Scalar>& b, const NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                                     const Threads& threads) const {
  const Rows<Scalar> rows(level_, matrix_, inverses_);
  threads.for_chunks(level_.pattern.rows(), kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(r, i) = lanes(b, i) - rows.full_sum(i, x.data());
  });
}

template <typename Scalar>
void Smoother<Scalar>::find_swept_residual(const NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                                           const Threads& threads) const {
  const Rows<Scalar> rows(level_, matrix_, inverses_);
  threads.for_chunks(level_.pattern.rows(), kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(r, i) = lanes(left_sums_, i) - rows.left_sum(i, x.data());
  });
}

template <typename Scalar>
std::int64_t Smoother<Scalar>::bytes() const {
  return static_cast<std::int64_t>((inverses_.size() + left_sums_.size()) * sizeof(Scalar));
}

template class Smoother<float>;
template class Smoother<double>;

}  // namespace softreel
