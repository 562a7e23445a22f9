#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>
#include <utility>

#include "core/base/check.h"
#include "core/elasticity/float_assembly.h"
#include "core/elasticity/short_vectors_simd.h"

namespace softreel {
namespace {

constexpr std::int64_t kRowGrain = 128;

/// A row of a block, or a gradient, with a fourth lane that is not used. Blocks are sums of short rows, not batches, so
/// the lanes are those of one row.
using Row = detail::FourFloats;
using UnalignedRow = detail::FourFloatsAnywhere;

using Rows = std::array<Row, 3>;

[[gnu::always_inline]] inline Row load(const float* from) {
  return *reinterpret_cast<const UnalignedRow*>(from);
}

/// a x b; the fourth lane means nothing.
[[gnu::always_inline]] inline Row cross(const Row& a, const Row& b) {
  const Row difference = a * __builtin_shufflevector(b, b, 1, 2, 0, 3) - __builtin_shufflevector(a, a, 1, 2, 0, 3) * b;
  return __builtin_shufflevector(difference, difference, 1, 2, 0, 3);
}

/// Sums of g_i g_j^T, of r g_i g_j^T and of [g_i]x C [g_j]x^T by rows.
template <bool kUniform, bool kCurved>
struct Products {
  Rows plain{}, weighted{}, curved{};

  [[gnu::always_inline]] void add(const float* gi, const float* gj) {
    const Row row = load(gj);
    for (std::size_t k = 0; k < 3; ++k) {
      const Row outer = gi[k] * row;
      plain[k] += outer;
      if constexpr (!kUniform) weighted[k] += gj[3] * outer;
    }
  }

  /// C: its three rows; null is none. Row k of C [g_j]x^T is g_j times row k of C.
  [[gnu::always_inline]] void add_curvature(const float* gi, const float* gj, const float* C) {
    if (C == nullptr) return;
    const Row g = load(gj), w0 = cross(g, load(C)), w1 = cross(g, load(C + 4)), w2 = cross(g, load(C + 8));
    curved[0] += gi[1] * w2 - gi[2] * w1;
    curved[1] += gi[2] * w0 - gi[0] * w2;
    curved[2] += gi[0] * w1 - gi[1] * w0;
  }
};

[[gnu::always_inline]] inline Rows scaled(const Rows& rows, float factor) {
  return {factor * rows[0], factor * rows[1], factor * rows[2]};
}

[[gnu::always_inline]] inline Rows transposed(const Rows& m) {
  const Row low = __builtin_shufflevector(m[0], m[1], 0, 4, 1, 5),
            high = __builtin_shufflevector(m[0], m[1], 2, 6, 3, 7);
  return {__builtin_shufflevector(low, m[2], 0, 1, 4, 4), __builtin_shufflevector(low, m[2], 2, 3, 5, 5),
          __builtin_shufflevector(high, m[2], 0, 1, 6, 6)};
}

/// The trace in all lanes.
[[gnu::always_inline]] inline Row trace(const Rows& m) {
  return (__builtin_shufflevector(m[0], m[0], 0, 0, 0, 0) + __builtin_shufflevector(m[1], m[1], 1, 1, 1, 1)) +
         __builtin_shufflevector(m[2], m[2], 2, 2, 2, 2);
}

/// Stores a + b + diagonal I by rows: nine scalars in three overlapping stores that stay inside of the block.
[[gnu::always_inline]] inline void store(const Rows& a, const Rows& b, const Row& diagonal, float* block) {
  const Row row0 = a[0] + b[0] + diagonal * Row{1, 0, 0, 0}, row1 = a[1] + b[1] + diagonal * Row{0, 1, 0, 0},
            row2 = a[2] + b[2] + diagonal * Row{0, 0, 1, 0};
  *reinterpret_cast<UnalignedRow*>(block) = row0;
  *reinterpret_cast<UnalignedRow*>(block + 3) = row1;
  *reinterpret_cast<UnalignedRow*>(block + 5) = __builtin_shufflevector(row1, row2, 2, 4, 5, 6);
}

[[gnu::always_inline]] inline Rows sum(const Rows& a, const Rows& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// K_ij = L + P^T + tr(P) I + curved and its transpose K_ji, by columns: the rows of K_ij are the columns of K_ji.
template <bool kUniform, bool kCurved>
[[gnu::always_inline]] inline void store_pair(const Products<kUniform, kCurved>& products, float ratio, float* block,
                                              float* mirror) {
  const Rows& P = products.plain;
  const Rows P_t = transposed(P);
  const Row diagonal = trace(P);
  Rows L = kUniform ? scaled(P, ratio) : products.weighted;
  if constexpr (kCurved) L = sum(L, products.curved);
  store(L, P_t, diagonal, mirror);
  if constexpr (kUniform && !kCurved)
    store(scaled(P_t, ratio), P, diagonal, block);
  else
    store(transposed(L), P, diagonal, block);
}

}  // namespace

FloatAssembler::FloatAssembler(const std::vector<Tet>& tets, const NodeElements& node_elements,
                               const BlockPattern& target, std::span<const Index> row_of_node)
    : node_elements_(node_elements) {
  CHECK(tets.size() < (std::size_t{1} << 28));
  CHECK(target.blocks() < std::int64_t{std::numeric_limits<std::uint32_t>::max()});
  const auto position = [&](Index i, Index j) {
    return target.find(row_of_node[static_cast<std::size_t>(i)], row_of_node[static_cast<std::size_t>(j)]);
  };
  std::vector<std::pair<Index, std::uint32_t>> row;  // column and reference
  row_starts_.push_back(0);
  for (std::size_t i = 0; i < row_of_node.size(); ++i) {
    const auto node = static_cast<Index>(i);
    diagonals_.push_back(position(node, node));
    row.clear();
    for (std::int64_t k = node_elements.offsets[i]; k < node_elements.offsets[i + 1]; ++k) {
      const std::uint32_t entry = node_elements.entries[static_cast<std::size_t>(k)];
      const Tet& tet = tets[entry / 4];
      for (std::size_t j = 0; j < 4; ++j)
        if (tet[j] > node)
          row.emplace_back(tet[j], static_cast<std::uint32_t>(4 * static_cast<std::size_t>(entry) + j));
    }
    std::sort(row.begin(), row.end());
    for (std::size_t k = 0; k < row.size(); ++k) {
      const Index column = row[k].first;
      if (k == 0 || column != row[k - 1].first)
        blocks_.push_back({static_cast<std::uint32_t>(position(node, column)),
                           static_cast<std::uint32_t>(position(column, node)),
                           static_cast<std::uint32_t>(references_.size())});
      references_.push_back(row[k].second);
    }
    row_starts_.push_back(static_cast<std::int64_t>(blocks_.size()));
  }
  blocks_.push_back({0, 0, static_cast<std::uint32_t>(references_.size())});
  blocks_.shrink_to_fit();
  references_.shrink_to_fit();
}

template <bool kUniform, bool kCurved>
void FloatAssembler::gather_blocks(const StepTerms& terms, BlockMatrixf& matrix, std::size_t i) const {
  const float* const gradients = terms.gradients.data();
  for (std::int64_t b = row_starts_[i]; b < row_starts_[i + 1]; ++b) {
    const Block& block = blocks_[static_cast<std::size_t>(b)];
    const std::uint32_t last = blocks_[static_cast<std::size_t>(b) + 1].first;
    Products<kUniform, kCurved> products;
    for (std::uint32_t r = block.first; r < last; ++r) {
      const std::size_t reference = references_[r];
      const float* const gi = gradients + 4 * (reference >> 2);
      const float* const gj = gradients + 16 * (reference >> 4) + 4 * (reference & 3);
      products.add(gi, gj);
      if constexpr (kCurved) products.add_curvature(gi, gj, terms.curvature_of(reference >> 4));
    }
    store_pair(products, gradients[3], matrix.block(block.position), matrix.block(block.mirror));
  }
}

template <bool kUniform, bool kCurved>
void FloatAssembler::gather_row(const StepTerms& terms, double node_term, BlockMatrixf& matrix, std::size_t i) const {
  const float* const gradients = terms.gradients.data();
  Products<kUniform, kCurved> own;
  bool has_curvature = false;
  for (std::int64_t k = node_elements_.offsets[i]; k < node_elements_.offsets[i + 1]; ++k) {
    const std::uint32_t entry = node_elements_.entries[static_cast<std::size_t>(k)];
    const float* const g = gradients + std::size_t{4} * entry;
    own.add(g, g);
    if constexpr (kCurved) {
      const float* const C = terms.curvature_of(entry / 4);
      has_curvature = has_curvature || (C != nullptr && C[0] + C[5] + C[10] > 0);
      own.add_curvature(g, g, C);
    }
  }
  Rows L = kUniform ? scaled(own.plain, gradients[3]) : own.weighted;
  // A sum of g g^T is symmetric to the last bit as it is.
  if constexpr (kCurved) L = sum(L, scaled(sum(own.curved, transposed(own.curved)), 0.5F));
  store(L, own.plain, trace(own.plain) + static_cast<float>(node_term), matrix.block(diagonals_[i]));
  if (kCurved && has_curvature)
    gather_blocks<kUniform, true>(terms, matrix, i);
  else
    gather_blocks<kUniform, false>(terms, matrix, i);
}

void FloatAssembler::assemble(const StepTerms& terms, std::span<const double> node_terms,
                              std::span<const std::uint8_t> rows, BlockMatrixf& matrix, const Threads& threads) const {
  CHECK(static_cast<std::int64_t>(matrix.values.size()) >= 9 * matrix.pattern.blocks());
  CHECK(node_terms.size() == diagonals_.size());
  CHECK((rows.empty() || rows.size() == diagonals_.size()));
  const bool curved = std::any_of(terms.curvatures.begin(), terms.curvatures.end(),
                                  [](const AlignedVector<float>& slab) { return !slab.empty(); });
  const auto gather = [&](auto uniform, auto with_curvatures, std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      if (rows.empty() || rows[i] != 0) gather_row<uniform(), with_curvatures()>(terms, node_terms[i], matrix, i);
  };
  threads.for_chunks(static_cast<std::int64_t>(diagonals_.size()), kRowGrain,
                     [&](std::int64_t begin, std::int64_t end) {
                       const std::true_type yes;
                       const std::false_type no;
                       if (terms.uniform_ratio && curved) gather(yes, yes, begin, end);
                       if (terms.uniform_ratio && !curved) gather(yes, no, begin, end);
                       if (!terms.uniform_ratio && curved) gather(no, yes, begin, end);
                       if (!terms.uniform_ratio && !curved) gather(no, no, begin, end);
                     });
}

}  // namespace softreel
