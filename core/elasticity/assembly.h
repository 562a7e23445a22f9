/// Elements into the global matrix through precomputed block references (paper sec. 4.2), turned round: each block
/// gathers its elements, which needs no atomics and has a fixed order (design 4.3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned.h"
#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/elasticity/elastic_body.h"
#include "core/sparse/block_matrix.h"

namespace softreel {

/// Per element, what its ten different blocks are made of. With g_i = sqrt(s V mu) Q b_i and s the element's share in
/// the matrix (h^2 + h damping_stiffness in a time step, 1 in statics):
/// block(i, j) = ratio g_i g_j^T + g_j g_i^T + (g_i . g_j) I + [g_i]x curvature [g_j]x^T.
struct StiffnessTerms {
  AlignedVector<double> gradients;  ///< g_i as x y z 0, so that a row of a block is one vector: elements x 4 x 4
  std::vector<double> ratios;       ///< slope of the dilatation stress over mu: the tangent's, or step_pressure_slope
  std::vector<Mat3> curvatures;     ///< rotation_curvature over mu; empty: left out
  /// True if all ratios are equal; then one gather makes both products.
  bool uniform_ratio = false;
};

/// Whether the rotation's own curvature enters the matrix (statics), and with which sign (design 4.4).
enum class Curvature { None, Signed, PositivePart };

/// Terms of all elements at a state. shares: s per element.
void find_stiffness_terms(const ElasticBody& body, std::span<const Vec3> positions,
                          std::span<const Quaternion> rotations, std::span<const double> shares, Curvature curvature,
                          StiffnessTerms& terms, const Threads& threads);

/// The references of one mesh: made once, used for every matrix on its pattern.
class StiffnessAssembler {
 public:
  /// pattern: stiffness_pattern(tets, nodes).
  StiffnessAssembler(const std::vector<Tet>& tets, const BlockPattern& pattern);

  /// matrix = diag(node_terms I) + sum of the elements' blocks; symmetric to the last bit. matrix.values is resized.
  void assemble(const StiffnessTerms& terms, std::span<const double> node_terms, BlockMatrixd& matrix,
                const Threads& threads) const;

 private:
  /// A block of the upper triangle and its mirror image, equal on the diagonal; its references are those from `first`
  /// to the next block's.
  struct UpperBlock {
    std::uint32_t position, mirror, first;
  };

  /// uniform: the ratios are; curved: there are curvatures.
  template <bool kUniform, bool kCurved>
  Mat3 gather_block(const StiffnessTerms& terms, const UpperBlock* block, double node_term) const;
  template <bool kUniform, bool kCurved>
  void gather_rows(const StiffnessTerms& terms, std::span<const double> node_terms, BlockMatrixd& matrix,
                   std::int64_t begin, std::int64_t end) const;

  std::vector<std::int64_t> row_starts_;   ///< upper blocks of row i: [row_starts_[i], row_starts_[i + 1])
  std::vector<UpperBlock> blocks_;         ///< by rows, the diagonal first; one more as the end
  std::vector<std::uint32_t> references_;  ///< 16 * element + 4 * local row + local column, ascending per block
};

}  // namespace softreel
