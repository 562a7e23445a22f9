#include "core/elasticity/assembly.h"

#include <cmath>

#include "core/base/check.h"

namespace softreel {
namespace {

constexpr std::int64_t kElementGrain = 1024;
constexpr std::int64_t kRowGrain = 256;

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Terms of element e; returns its ratio.
double find_element_terms(const ElasticBody& body, std::size_t e, std::span<const Vec3> positions, const Mat3& rotation,
                          double share, Curvature curvature, StiffnessTerms& terms) {
  const ElementShape& shape = body.shapes[e];
  const ElasticLaw& law = body.laws[e];
  const Mat3 F = deformation_gradient(shape.gradients, nodes_of(body.tets[e], positions));
  const double trace = rotation.cwiseProduct(F).sum() - 3;
  terms.gradients[e] = (std::sqrt(share * shape.volume * law.mu) * rotation) * shape.gradients;
  terms.ratios[e] = law.pressure_slope(trace) / law.mu;
  if (curvature != Curvature::None)
    terms.curvatures[e] = rotation_curvature(law, rotation, F, curvature == Curvature::PositivePart) / law.mu;
  return terms.ratios[e];
}

}  // namespace

void find_stiffness_terms(const ElasticBody& body, std::span<const Vec3> positions,
                          std::span<const Quaternion> rotations, std::span<const double> shares, Curvature curvature,
                          StiffnessTerms& terms, const Threads& threads) {
  const std::size_t elements = body.tets.size();
  terms.gradients.resize(elements);
  terms.ratios.resize(elements);
  terms.curvatures.resize(curvature == Curvature::None ? 0 : elements);
  const double differences =
      threads.sum_chunks(static_cast<std::int64_t>(elements), kElementGrain, [&](std::int64_t begin, std::int64_t end) {
        const double expected = body.laws[0].lambda / body.laws[0].mu;
        double different = 0;
        for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e)
          different += find_element_terms(body, e, positions, rotations[e].toRotationMatrix(), shares[e], curvature,
                                          terms) == expected
                           ? 0
                           : 1;
        return different;
      });
  terms.uniform_ratio = differences == 0;
}

StiffnessAssembler::StiffnessAssembler(const std::vector<Tet>& tets, const BlockPattern& pattern) {
  CHECK(tets.size() < (std::size_t{1} << 28));
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
      blocks_.push_back({b, pattern.find(pattern.column_indices[at], row), counts[at], counts[at + 1]});
    }
    row_starts_.push_back(static_cast<std::int64_t>(blocks_.size()));
  }
}

template <bool kUniform, bool kCurved>
void StiffnessAssembler::gather_rows(const StiffnessTerms& terms, std::span<const double> node_terms,
                                     BlockMatrixd& matrix, Index begin, Index end) const {
  const double common_ratio = kUniform && !terms.ratios.empty() ? terms.ratios[0] : 0.0;
  for (auto row = static_cast<std::size_t>(begin); row < static_cast<std::size_t>(end); ++row)
    for (std::int64_t k = row_starts_[row]; k < row_starts_[row + 1]; ++k) {
      const UpperBlock& block = blocks_[static_cast<std::size_t>(k)];
      Mat3 product = Mat3::Zero(), weighted = Mat3::Zero(), curved = Mat3::Zero();
      for (std::int64_t r = block.first; r < block.last; ++r) {
        const std::uint32_t reference = references_[static_cast<std::size_t>(r)];
        const std::size_t e = reference >> 4;
        const Gradients& g = terms.gradients[e];
        const Vec3 gi = g.col((reference >> 2) & 3), gj = g.col(reference & 3);
        const Mat3 outer = gi * gj.transpose();
        product += outer;
        if constexpr (!kUniform) weighted += terms.ratios[e] * outer;
        if constexpr (kCurved) curved -= cross_matrix(gi) * terms.curvatures[e] * cross_matrix(gj);
      }
      if constexpr (kUniform) weighted = common_ratio * product;
      double diagonal = product.trace();
      const bool on_diagonal = block.position == block.mirror;
      if (on_diagonal) diagonal += node_terms[row];
      Mat3 value = weighted + product.transpose() + diagonal * Mat3::Identity();
      if constexpr (kCurved) value += curved;
      // Symmetric diagonal blocks to the last bit, whatever the order of the sums above.
      if (on_diagonal) value = (0.5 * (value + value.transpose())).eval();
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(matrix.block(block.position)) = value;
      if (!on_diagonal)
        Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(matrix.block(block.mirror)) = value.transpose();
    }
}

void StiffnessAssembler::assemble(const StiffnessTerms& terms, std::span<const double> node_terms, BlockMatrixd& matrix,
                                  const Threads& threads) const {
  matrix.values.resize(9 * static_cast<std::size_t>(matrix.pattern.blocks()));
  const bool curved = !terms.curvatures.empty();
  threads.for_chunks(matrix.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    const auto first = static_cast<Index>(begin), last = static_cast<Index>(end);
    if (curved && terms.uniform_ratio) gather_rows<true, true>(terms, node_terms, matrix, first, last);
    if (curved && !terms.uniform_ratio) gather_rows<false, true>(terms, node_terms, matrix, first, last);
    if (!curved && terms.uniform_ratio) gather_rows<true, false>(terms, node_terms, matrix, first, last);
    if (!curved && !terms.uniform_ratio) gather_rows<false, false>(terms, node_terms, matrix, first, last);
  });
}

}  // namespace softreel
