/// The matrix of a time step in float, straight into the rows that the smoother wants.
///
/// Each block above the diagonal gathers its elements once, in the mesh's order, for itself and its mirror image.
/// Bound: per tetrahedron 10 products of two 16-byte gradients from cache, and 2.5 blocks of 36 bytes written.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/elasticity/elastic_body.h"
#include "core/elasticity/step_terms.h"
#include "core/sparse/block_matrix.h"

namespace softreel {

/// The references of one mesh: made once, used at every step. The float twin of StiffnessAssembler.
class FloatAssembler {
 public:
  /// target: pattern of the result, with mesh node i in row row_of_node[i]. node_elements is kept by reference.
  FloatAssembler(const std::vector<Tet>& tets, const NodeElements& node_elements, const BlockPattern& target,
                 std::span<const Index> row_of_node);

  /// matrix = diag(node_terms I) + sum of the elements' blocks with their curvatures, column-major blocks; symmetric to
  /// the last bit. node_terms: per mesh node. matrix: on the target pattern, with room. rows: per mesh node, 1 where
  /// what the node shares with nodes after it is to be made anew; the rest of the matrix stays. Empty: all is made.
  void assemble(const StepTerms& terms, std::span<const double> node_terms, std::span<const std::uint8_t> rows,
                BlockMatrixf& matrix, const Threads& threads) const;

 private:
  /// A block (i, j), i < j by mesh nodes, and (j, i); its references are those from `first` to the next block's.
  struct Block {
    std::uint32_t position, mirror, first;
  };

  /// kUniform: the ratios are; kCurved: there may be curvatures.
  template <bool kUniform, bool kCurved>
  void gather_row(const StepTerms& terms, double node_term, BlockMatrixf& matrix, std::size_t i) const;
  template <bool kUniform, bool kCurved>
  void gather_blocks(const StepTerms& terms, BlockMatrixf& matrix, std::size_t i) const;

  const NodeElements& node_elements_;
  std::vector<std::int64_t> diagonals_;    ///< position of each mesh node's diagonal block
  std::vector<std::int64_t> row_starts_;   ///< blocks of mesh row i: [row_starts_[i], row_starts_[i + 1])
  std::vector<Block> blocks_;              ///< by mesh rows; one more as the end
  std::vector<std::uint32_t> references_;  ///< 16 * element + 4 * node of i + node of j, ascending per block
};

}  // namespace softreel
