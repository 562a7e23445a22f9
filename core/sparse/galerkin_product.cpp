#include "core/sparse/galerkin_product.h"

#include <array>

#include "core/base/check.h"

namespace softreel {
namespace {

/// sum over k in S^K_l and S^R_j of K_lk R_jk, times `factor`, added to `sum`: the inner sum of eq. (9).
template <typename Scalar>
void add_inner_sum(const BlockMatrix<Scalar>& K, std::size_t l, const WeightMatrix& R, std::size_t j, double factor,
                   std::array<Scalar, 9>& sum) {
  std::int64_t k = K.pattern.row_offsets[l], c = R.row_offsets[j];
  const std::int64_t k_end = K.pattern.row_offsets[l + 1], c_end = R.row_offsets[j + 1];
  while (k < k_end && c < c_end) {
    const Index k_column = K.pattern.column_indices[static_cast<std::size_t>(k)];
    const Index r_column = R.column_indices[static_cast<std::size_t>(c)];
    if (k_column == r_column) {
      const auto weight = static_cast<Scalar>(factor * R.weights[static_cast<std::size_t>(c)]);
      const Scalar* const block = K.block(k);
      for (std::size_t s = 0; s < 9; ++s) sum[s] += weight * block[s];
    }
    k += k_column <= r_column;
    c += r_column <= k_column;
  }
}

}  // namespace

template <typename Scalar>
void galerkin_product(const BlockMatrix<Scalar>& K, const WeightMatrix& R, BlockMatrix<Scalar>& E) {
  CHECK(R.columns == K.pattern.rows());
  CHECK(E.pattern.rows() == R.rows());
  CHECK(static_cast<std::int64_t>(E.values.size()) >= 9 * E.pattern.blocks());
  for (std::size_t i = 0; i < static_cast<std::size_t>(R.rows()); ++i)
    for (std::int64_t e = E.pattern.row_offsets[i]; e < E.pattern.row_offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(E.pattern.column_indices[static_cast<std::size_t>(e)]);
      std::array<Scalar, 9> sum{};
      for (std::int64_t a = R.row_offsets[i]; a < R.row_offsets[i + 1]; ++a) {
        const auto entry = static_cast<std::size_t>(a);
        add_inner_sum(K, static_cast<std::size_t>(R.column_indices[entry]), R, j, R.weights[entry], sum);
      }
      for (std::size_t s = 0; s < 9; ++s) E.block(e)[s] = sum[s];
    }
}

template void galerkin_product(const BlockMatrixf&, const WeightMatrix&, BlockMatrixf&);
template void galerkin_product(const BlockMatrixd&, const WeightMatrix&, BlockMatrixd&);

}  // namespace softreel
