/// StiffnessAssembler::assemble on rows of blocks in registers.
#include <array>

#include "core/elasticity/assembly.h"
#include "core/elasticity/short_vectors_simd.h"

namespace softreel {
namespace {

constexpr std::int64_t kAssembledRowGrain = 256;

/// A row of a block, or a gradient; the fourth is 0 or means nothing.
using Row = detail::FourDoubles;
using Rows = std::array<Row, 3>;

[[gnu::always_inline]] inline Row load(const double* from) {
  return *reinterpret_cast<const detail::FourStoredDoubles*>(from);
}

/// a x b; the fourth means nothing.
[[gnu::always_inline]] inline Row cross(const Row& a, const Row& b) {
  const Row difference = a * __builtin_shufflevector(b, b, 1, 2, 0, 3) - __builtin_shufflevector(a, a, 1, 2, 0, 3) * b;
  return __builtin_shufflevector(difference, difference, 1, 2, 0, 3);
}

/// += [g_i]x C [g_j]x^T by rows. Row k of C [g_j]x^T is g_j times row k of C, which is its column as well.
[[gnu::always_inline]] inline void add_curvature(const double* gi, const Row& gj, const Mat3& C, Rows& curved) {
  const double* const c = C.data();
  const Row w0 = cross(gj, Row{c[0], c[1], c[2], 0}), w1 = cross(gj, Row{c[3], c[4], c[5], 0}),
            w2 = cross(gj, Row{c[6], c[7], c[8], 0});
  curved[0] += gi[1] * w2 - gi[2] * w1;
  curved[1] += gi[2] * w0 - gi[0] * w2;
  curved[2] += gi[0] * w1 - gi[1] * w0;
}

Mat3 matrix_of(const Rows& rows) {
  Mat3 m;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) m(r, c) = rows[static_cast<std::size_t>(r)][c];
  return m;
}

void store_block(const Mat3& value, double* block) {
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> destination(block);
  destination = value;
}

}  // namespace

template <bool kUniform, bool kCurved>
Mat3 StiffnessAssembler::gather_block(const StiffnessTerms& terms, const UpperBlock* block, double node_term) const {
  Rows product{}, weighted{}, curved{};
  for (std::uint32_t r = block[0].first; r < block[1].first; ++r) {
    const std::uint32_t reference = references_[r];
    const std::size_t e = reference >> 4;
    const double* const gi = &terms.gradients[4 * (reference >> 2)];
    const Row gj = load(&terms.gradients[16 * e + 4 * (reference & 3)]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Row outer = gi[k] * gj;
      product[k] += outer;
      if constexpr (!kUniform) weighted[k] += terms.ratios[e] * outer;
    }
    if constexpr (kCurved) add_curvature(gi, gj, terms.curvatures[e], curved);
  }
  const Mat3 P = matrix_of(product);
  Mat3 value = kUniform ? Mat3((terms.ratios.empty() ? 0.0 : terms.ratios[0]) * P) : matrix_of(weighted);
  value += P.transpose();
  if constexpr (kCurved) value += matrix_of(curved);
  value.diagonal().array() += P.trace() + node_term;
  return value;
}

template <bool kUniform, bool kCurved>
void StiffnessAssembler::gather_rows(const StiffnessTerms& terms, std::span<const double> node_terms,
                                     BlockMatrixd& matrix, std::int64_t begin, std::int64_t end) const {
  for (auto row = static_cast<std::size_t>(begin); row < static_cast<std::size_t>(end); ++row)
    for (std::int64_t k = row_starts_[row]; k < row_starts_[row + 1]; ++k) {
      const UpperBlock& block = blocks_[static_cast<std::size_t>(k)];
      if (block.position == block.mirror) {
        const Mat3 value = gather_block<kUniform, kCurved>(terms, &block, node_terms[row]);
        // Symmetric to the last bit, whatever the order of the sums.
        store_block(0.5 * (value + value.transpose()), matrix.block(block.position));
      } else {
        const Mat3 value = gather_block<kUniform, kCurved>(terms, &block, 0.0);
        store_block(value, matrix.block(block.position));
        store_block(value.transpose(), matrix.block(block.mirror));
      }
    }
}

void StiffnessAssembler::assemble(const StiffnessTerms& terms, std::span<const double> node_terms, BlockMatrixd& matrix,
                                  const Threads& threads) const {
  matrix.values.resize(9 * static_cast<std::size_t>(matrix.pattern.blocks()));
  const bool curved = !terms.curvatures.empty();
  const bool uniform = terms.uniform_ratio;
  threads.for_chunks(matrix.pattern.rows(), kAssembledRowGrain, [&](std::int64_t begin, std::int64_t end) {
    if (curved && uniform) gather_rows<true, true>(terms, node_terms, matrix, begin, end);
    if (curved && !uniform) gather_rows<false, true>(terms, node_terms, matrix, begin, end);
    if (!curved && uniform) gather_rows<true, false>(terms, node_terms, matrix, begin, end);
    if (!curved && !uniform) gather_rows<false, false>(terms, node_terms, matrix, begin, end);
  });
}

}  // namespace softreel
