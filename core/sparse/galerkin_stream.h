/// E = R K R^T by the paper's control and data stream (sec. 4.3.1, Algorithm 1), on 3x3 blocks.
///
/// The streams follow the blocks of K in storage order: for each block a control byte says how many pairs of weight and
/// index into E follow. Reads are sequential, only the writes to E are scattered; so it runs on one thread.
#pragma once

#include <cstdint>
#include <vector>

#include "core/sparse/block_matrix.h"
#include "core/sparse/weight_matrix.h"

namespace softreel {

/// The streams of one product; they depend on the patterns and R only.
///
/// Differences from the paper. Its Algorithm 1 starts one loop at 1 and another at 0; here both start at 0, half-open.
/// In the paper every block's first control byte says "next", so step 1 would skip the first entry of K: here the
/// traversal starts one block before the first, which the first control byte leaves.
template <typename Scalar>
class GalerkinStream {
 public:
  /// E_pattern: galerkin_pattern(K_pattern, R, transpose(R)).
  GalerkinStream(const BlockPattern& K_pattern, const WeightMatrix& R_transposed, const BlockPattern& E_pattern);

  /// Fills E.values, which must have room, from K.values; the patterns are those of the constructor.
  void run(const BlockMatrix<Scalar>& K, BlockMatrix<Scalar>& E) const;

  std::int64_t bytes() const;
  /// The control bytes: bit 7 set = go on to the next block of K; bits 0 to 6 = number of pairs, at most 127.
  const std::vector<std::uint8_t>& control() const { return control_; }

 private:
  struct Pair {
    Scalar weight;
    std::uint32_t target;  ///< block of E
  };
  static constexpr std::uint8_t kNextBit = 0x80;
  static constexpr std::uint8_t kMaxPairs = 0x7f;

  void set_next() { control_.push_back(kNextBit); }
  void push(Scalar weight, std::int64_t target);

  std::vector<std::uint8_t> control_;
  std::vector<Pair> data_;
};

}  // namespace softreel
