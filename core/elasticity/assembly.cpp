#include "core/elasticity/assembly.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/base/check.h"

namespace softreel {
namespace {

constexpr std::int64_t kAssemblyGrain = 1024;
constexpr std::int64_t kAssembledRowGrain = 256;

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// A row of a block, or a gradient, in vector lanes; the fourth is 0.
using Row = Eigen::Array4d;
using RowMap = Eigen::Map<const Row, Eigen::Aligned32>;

/// One element on its way into the matrix.
struct ElementSource {
  const ElementShape& shape;
  const ElasticLaw& law;
  Mat3 rotation, F, strain;
};

ElementSource find_source(const ElasticBody& body, std::size_t e, std::span<const Vec3> positions,
                          const Quaternion& rotation) {
  ElementSource source{body.shapes[e], body.laws[e], rotation.toRotationMatrix(), {}, {}};
  source.F = deformation_gradient(source.shape.gradients, nodes_of(body.tets[e], positions));
  source.strain = corotated_strain(source.rotation, source.F);
  return source;
}

void store_gradients(const ElementSource& source, double share, double* gradients) {
  const Mat3 scaled = std::sqrt(share * source.shape.volume * source.law.mu) * source.rotation;
  for (int k = 0; k < 4; ++k) {
    const Vec3 g = scaled * source.shape.gradients.col(k);
    Eigen::Map<Row, Eigen::Aligned32>(gradients + 4 * k) = Row(g.x(), g.y(), g.z(), 0);
  }
}

void store_block(const Mat3& value, double* block) {
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> destination(block);
  destination = value;
}

Mat3 matrix_of(const std::array<Row, 3>& rows) {
  Mat3 m;
  for (int r = 0; r < 3; ++r) m.row(r) = rows[static_cast<std::size_t>(r)].head<3>().matrix().transpose();
  return m;
}

}  // namespace

void find_stiffness_terms(const ElasticBody& body, std::span<const Vec3> positions,
                          std::span<const Quaternion> rotations, std::span<const double> shares, Curvature curvature,
                          StiffnessTerms& terms, const Threads& threads) {
  const std::size_t elements = body.tets.size();
  const double expected_ratio = elements > 0 ? body.laws[0].lambda / body.laws[0].mu : 0.0;
  terms.gradients.resize(16 * elements);
  terms.ratios.resize(elements);
  terms.curvatures.resize(curvature == Curvature::None ? 0 : elements);
  const auto chunk = [&](std::int64_t begin, std::int64_t end) {
    double different = 0;
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
      const ElementSource source = find_source(body, e, positions, rotations[e]);
      store_gradients(source, shares[e], &terms.gradients[16 * e]);
      terms.ratios[e] = source.law.pressure_slope(source.strain.trace()) / source.law.mu;
      if (terms.ratios[e] != expected_ratio) ++different;
      if (curvature != Curvature::None)
        terms.curvatures[e] =
            rotation_curvature(source.law, source.rotation, source.F, curvature == Curvature::PositivePart) /
            source.law.mu;
    }
    return different;
  };
  terms.uniform_ratio = threads.sum_chunks(static_cast<std::int64_t>(elements), kAssemblyGrain, chunk) == 0;
}

StiffnessAssembler::StiffnessAssembler(const std::vector<Tet>& tets, const BlockPattern& pattern) {
  CHECK(tets.size() < (std::size_t{1} << 28));
  CHECK(pattern.blocks() < std::int64_t{std::numeric_limits<std::uint32_t>::max()});
  std::vector<std::int64_t> counts(static_cast<std::size_t>(pattern.blocks()) + 1, 0);
  const auto for_upper = [&](auto&& visit) {
    for (std::size_t e = 0; e < tets.size(); ++e)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
          if (tets[e][i] <= tets[e][j])
            visit(pattern.find(tets[e][i], tets[e][j]), static_cast<std::uint32_t>(16 * e + 4 * i + j));
  };
  for_upper([&](std::int64_t block, std::uint32_t) { ++counts[static_cast<std::size_t>(block) + 1]; });
  for (std::size_t b = 1; b < counts.size(); ++b) counts[b] += counts[b - 1];
  references_.resize(static_cast<std::size_t>(counts.back()));
  std::vector<std::int64_t> next(counts.begin(), counts.end() - 1);
  for_upper([&](std::int64_t block, std::uint32_t reference) {
    references_[static_cast<std::size_t>(next[static_cast<std::size_t>(block)]++)] = reference;
  });
  row_starts_.push_back(0);
  for (Index row = 0; row < pattern.rows(); ++row) {
    const auto r = static_cast<std::size_t>(row);
    for (std::int64_t b = pattern.row_offsets[r]; b < pattern.row_offsets[r + 1]; ++b) {
      const auto at = static_cast<std::size_t>(b);
      if (pattern.column_indices[at] < row) continue;
      blocks_.push_back({static_cast<std::uint32_t>(b),
                         static_cast<std::uint32_t>(pattern.find(pattern.column_indices[at], row)),
                         static_cast<std::uint32_t>(counts[at])});
    }
    row_starts_.push_back(static_cast<std::int64_t>(blocks_.size()));
  }
  blocks_.push_back({0, 0, static_cast<std::uint32_t>(references_.size())});
  blocks_.shrink_to_fit();
}

template <bool kUniform, bool kCurved>
Mat3 StiffnessAssembler::gather_block(const StiffnessTerms& terms, const UpperBlock* block, double node_term) const {
  std::array<Row, 3> product{Row::Zero(), Row::Zero(), Row::Zero()}, weighted = product;
  Mat3 curved = Mat3::Zero();
  for (std::uint32_t r = block[0].first; r < block[1].first; ++r) {
    const std::uint32_t reference = references_[r];
    const std::size_t e = reference >> 4;
    const double* const gi = &terms.gradients[4 * (reference >> 2)];
    const double* const gj = &terms.gradients[16 * e + 4 * (reference & 3)];
    const RowMap row(gj);
    for (std::size_t k = 0; k < 3; ++k) {
      const Row outer = gi[k] * row;
      product[k] += outer;
      if constexpr (!kUniform) weighted[k] += terms.ratios[e] * outer;
    }
    if constexpr (kCurved)
      curved -= cross_matrix({gi[0], gi[1], gi[2]}) * terms.curvatures[e] * cross_matrix({gj[0], gj[1], gj[2]});
  }
  const Mat3 P = matrix_of(product);
  const Mat3 L = kUniform ? Mat3((terms.ratios.empty() ? 0.0 : terms.ratios[0]) * P) : matrix_of(weighted);
  Mat3 value = L + P.transpose() + curved;
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
