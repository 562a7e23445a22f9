#include "core/sparse/galerkin_stream.h"

#include <algorithm>
#include <limits>

#include "core/base/check.h"

namespace softreel {

template <typename Scalar>
GalerkinStream<Scalar>::GalerkinStream(const BlockPattern& K_pattern, const WeightMatrix& R_transposed,
                                       const BlockPattern& E_pattern) {
  CHECK(R_transposed.rows() == K_pattern.rows());
  CHECK(E_pattern.blocks() < std::numeric_limits<std::uint32_t>::max());
  for (std::size_t l = 0; l < static_cast<std::size_t>(K_pattern.rows()); ++l)
    for (std::int64_t b = K_pattern.row_offsets[l]; b < K_pattern.row_offsets[l + 1]; ++b) {
      set_next();
      const auto k = static_cast<std::size_t>(K_pattern.column_indices[static_cast<std::size_t>(b)]);
      for (std::int64_t row = R_transposed.row_offsets[l]; row < R_transposed.row_offsets[l + 1]; ++row)
        for (std::int64_t column = R_transposed.row_offsets[k]; column < R_transposed.row_offsets[k + 1]; ++column) {
          const auto li = static_cast<std::size_t>(row), kj = static_cast<std::size_t>(column);
          push(static_cast<Scalar>(R_transposed.weights[li] * R_transposed.weights[kj]),
               E_pattern.find(R_transposed.column_indices[li], R_transposed.column_indices[kj]));
        }
    }
}

template <typename Scalar>
void GalerkinStream<Scalar>::push(Scalar weight, std::int64_t target) {
  CHECK(target >= 0);
  if ((control_.back() & kMaxPairs) == kMaxPairs) control_.push_back(0);
  ++control_.back();
  data_.push_back({weight, static_cast<std::uint32_t>(target)});
}

template <typename Scalar>
void GalerkinStream<Scalar>::run(const BlockMatrix<Scalar>& K, BlockMatrix<Scalar>& E) const {
  using Block = Eigen::Array<Scalar, 8, 1>;
  CHECK(static_cast<std::int64_t>(E.values.size()) >= 9 * E.pattern.blocks());
  std::fill(E.values.begin(), E.values.end(), Scalar{0});
  const Pair* pair = data_.data();
  const Scalar* block = K.values.data();
  const Scalar* next = block;
  for (const std::uint8_t control : control_) {
    if (control & kNextBit) {
      block = next;
      next += 9;
    }
    const Block head = Eigen::Map<const Block>(block);
    for (const Pair* const end = pair + (control & kMaxPairs); pair != end; ++pair) {
      Scalar* const target = E.block(pair->target);
      Eigen::Map<Block>{target} += pair->weight * head;
      target[8] += pair->weight * block[8];
    }
  }
}

template <typename Scalar>
std::int64_t GalerkinStream<Scalar>::bytes() const {
  return static_cast<std::int64_t>(control_.size() + data_.size() * sizeof(Pair));
}

template class GalerkinStream<float>;
template class GalerkinStream<double>;

}  // namespace softreel
