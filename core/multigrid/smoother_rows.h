/// The inner loops of the smoothers: sums over parts of a row, and its diagonal block solved.
#pragma once

#include <type_traits>

#include "core/multigrid/smoother.h"
#include "core/sparse/row_product_simd.h"

namespace softreel {

/// The rows of a level by plain pointers, for the inner loops.
template <typename Scalar>
struct Smoother<Scalar>::Rows {
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

}  // namespace softreel
