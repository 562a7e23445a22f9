#include "core/elasticity/assembly.h"

#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "core/elasticity/curvature_batch.h"

namespace softreel {
namespace {

constexpr std::int64_t kAssemblyGrain = 1024;

/// A gradient in vector lanes; the fourth is 0.
using Row = Eigen::Array4d;

/// One element on its way into the matrix.
struct ElementSource {
  const ElementShape& shape;
  const ElasticLaw& law;
  Mat3 rotation, strain;
};

ElementSource find_source(const ElasticBody& body, std::size_t e, std::span<const Vec3> positions,
                          const Quaternion& rotation) {
  ElementSource source{body.shapes[e], body.laws[e], rotation.toRotationMatrix(), {}};
  source.strain = corotated_strain(source.rotation,
                                   deformation_gradient(source.shape.gradients, nodes_of(body.tets[e], positions)));
  return source;
}

void store_gradients(const ElementSource& source, double share, double* gradients) {
  const Mat3 scaled = std::sqrt(share * source.shape.volume * source.law.mu) * source.rotation;
  for (int k = 0; k < 4; ++k) {
    const Vec3 g = scaled * source.shape.gradients.col(k);
    Eigen::Map<Row, Eigen::Aligned32>(gradients + 4 * k) = Row(g.x(), g.y(), g.z(), 0);
  }
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
    CurvatureBatch batch(curvature == Curvature::PositivePart);
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
      const ElementSource source = find_source(body, e, positions, rotations[e]);
      store_gradients(source, shares[e], &terms.gradients[16 * e]);
      terms.ratios[e] = source.law.pressure_slope(source.strain.trace()) / source.law.mu;
      if (terms.ratios[e] != expected_ratio) ++different;
      if (curvature == Curvature::None) continue;
      terms.curvatures[e].setZero();
      batch.add(source.law, source.rotation, source.strain, 1 / source.law.mu, terms.curvatures[e]);
    }
    batch.finish();
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

}  // namespace softreel
