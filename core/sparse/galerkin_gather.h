/// E = R K R^T for symmetric K, gathered: each block of E's upper triangle sums its weighted blocks of K.
///
/// Only blocks K_lk with l <= k are read; K_kl is their transpose. Every block of E is written once, so rows run in
/// parallel in any order with the same bits. Bound: about 2.2 products a block of K on BCC lattices, each 8 bytes of
/// plan and 36 of float block from cache, 18 operations: 3 to 4 cycles a product, 2.5 to 3.5 ns a block of K.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/sparse/block_matrix.h"
#include "core/sparse/weight_matrix.h"

namespace softreel {

/// The plan of one product; it depends on the patterns and R only.
template <typename Scalar>
class GalerkinGather {
 public:
  /// K_pattern: symmetric. E_pattern: galerkin_pattern(K_pattern, R, transpose(R)). rank: per row of K, in which order
  /// blocks that are near each other on the mesh lie near each other in memory; the blocks of E are made in that order,
  /// so that a block of K is read from cache by all that use it. It changes no bits. Empty: in the order of E.
  GalerkinGather(const BlockPattern& K_pattern, const WeightMatrix& R_transposed, const BlockPattern& E_pattern,
                 std::span<const Index> rank = {});

  /// Fills E.values, which must have room, from K.values; the patterns are those of the constructor. E is exactly
  /// symmetric.
  void run(const BlockMatrix<Scalar>& K, BlockMatrix<Scalar>& E, const Threads& threads) const;

  std::int64_t products() const { return static_cast<std::int64_t>(terms_.size()); }
  std::int64_t bytes() const;

 private:
  /// A weighted block of K.
  struct Term {
    std::uint32_t source;
    Scalar weight;
  };
  /// A block of E's upper triangle and its mirror; terms [direct, transposed) are added as they are, the terms
  /// [transposed, next target's direct) transposed. On the diagonal the sum is added to its own transpose.
  struct Target {
    std::int64_t direct;
    std::int64_t transposed;
    std::uint32_t block;
    std::uint32_t mirror;
  };

  /// E's upper triangle; target_of: per block of E.
  static std::vector<Target> make_targets(const BlockPattern& E_pattern, std::vector<std::uint32_t>& target_of);
  /// Sorts all targets but the last, which marks the end, by `first`.
  static void order_targets(const std::vector<Index>& first, std::vector<Target>& targets,
                            std::vector<std::uint32_t>& target_of);

  std::vector<Target> targets_;  ///< one more than there are, as the end
  std::vector<Term> terms_;
};

}  // namespace softreel
