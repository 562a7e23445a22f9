/// Products of block matrices with node vectors, and the sums over nodes that iterative solvers need.
///
/// All loops run over fixed chunks of rows: the same bits at any number of threads. Bound: a product reads each block
/// once, 9 scalars and a column index (76 bytes in double, 40 in float) for 18 operations, so memory decides.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/aligned.h"
#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/sparse/block_matrix.h"

namespace softreel {

/// One vector per node in four lanes, x y z 0, so that a node is one aligned load; 4 n scalars.
template <typename Scalar>
using NodeVector = AlignedVector<Scalar>;

/// The lanes of one node.
template <typename Scalar>
using NodeLanes = Eigen::Array<Scalar, 4, 1>;

/// Rows per chunk of node loops; that of sums decides their bits.
inline constexpr std::int64_t kRowGrain = 512;

/// Rows per chunk of loops that multiply matrix rows, of which a colour of a small level has some hundred: two
/// microseconds of work each.
inline constexpr std::int64_t kSweepGrain = 64;

template <typename Scalar>
Eigen::Map<const NodeLanes<Scalar>> lanes(const NodeVector<Scalar>& vector, std::int64_t node) {
  return Eigen::Map<const NodeLanes<Scalar>>(vector.data() + 4 * node);
}
template <typename Scalar>
Eigen::Map<NodeLanes<Scalar>> lanes(NodeVector<Scalar>& vector, std::int64_t node) {
  return Eigen::Map<NodeLanes<Scalar>>(vector.data() + 4 * node);
}

/// Sum of block * x[column] over the blocks [begin, end); the fourth lane of the result is 0.
///
/// Lane c of accumulator r sums K_rc x_c; each row of a block is loaded as four lanes, the fourth being the next row's
/// first scalar, which meets the zero of x. Only the very last block of the matrix must not be read past its end.
template <typename Scalar>
[[gnu::always_inline]] inline NodeLanes<Scalar> row_product(const BlockMatrix<Scalar>& matrix, std::int64_t begin,
                                                            std::int64_t end, const Scalar* x) {
  using Row = Eigen::Map<const NodeLanes<Scalar>>;
  const Index* const columns = matrix.pattern.column_indices.data();
  const std::int64_t last = matrix.pattern.blocks() - 1;
  NodeLanes<Scalar> sum0 = NodeLanes<Scalar>::Zero(), sum1 = sum0, sum2 = sum0;
  for (std::int64_t b = begin; b < (end > last ? last : end); ++b) {
    const Scalar* const block = matrix.block(b);
    const NodeLanes<Scalar> node = Row(x + 4 * std::int64_t{columns[b]});
    sum0 += Row(block) * node;
    sum1 += Row(block + 3) * node;
    sum2 += Row(block + 6) * node;
  }
  NodeLanes<Scalar> product(sum0[0] + sum0[1] + sum0[2], sum1[0] + sum1[1] + sum1[2], sum2[0] + sum2[1] + sum2[2], 0);
  if (end > last && begin < end) {
    const Scalar* const block = matrix.block(last);
    const Scalar* const node = x + 4 * std::int64_t{columns[last]};
    for (int r = 0; r < 3; ++r)
      product[r] += block[3 * r] * node[0] + block[3 * r + 1] * node[1] + block[3 * r + 2] * node[2];
  }
  return product;
}

/// The same for blocks stored column-major; the fourth lane of the result is unspecified.
///
/// The lanes are those of the result, so nothing is summed across them, which pays for the short half rows of a
/// smoother. In a symmetric matrix a column-major K_ij is a row-major K_ji. Reads one scalar past the last block: see
/// reserve_values.
template <typename Scalar>
[[gnu::always_inline]] inline NodeLanes<Scalar> column_major_row_product(const Scalar* values, const Index* columns,
                                                                         std::int64_t begin, std::int64_t end,
                                                                         const Scalar* x) {
  using Row = Eigen::Map<const NodeLanes<Scalar>>;
  NodeLanes<Scalar> sum0 = NodeLanes<Scalar>::Zero(), sum1 = sum0, sum2 = sum0;
  for (std::int64_t b = begin; b < end; ++b) {
    const Scalar* const block = values + 9 * b;
    const Scalar* const node = x + 4 * std::int64_t{columns[b]};
    sum0 += Row(block) * node[0];
    sum1 += Row(block + 3) * node[1];
    sum2 += Row(block + 6) * node[2];
  }
  return sum0 + (sum1 + sum2);
}

/// Room for all values of the pattern, zero, and for the lanes that reach past the last block.
template <typename Scalar>
void reserve_values(BlockMatrix<Scalar>& matrix) {
  matrix.values.assign(static_cast<std::size_t>(9 * matrix.pattern.blocks()) + 3, Scalar{0});
}

/// y = A x.
template <typename Scalar>
void multiply(const BlockMatrix<Scalar>& A, const NodeVector<Scalar>& x, NodeVector<Scalar>& y, const Threads& threads);

/// y = A x; returns x . y.
double multiply_and_dot(const BlockMatrixd& A, const NodeVector<double>& x, NodeVector<double>& y,
                        const Threads& threads);

/// r = b - A x.
template <typename Scalar>
void residual(const BlockMatrix<Scalar>& A, const NodeVector<Scalar>& b, const NodeVector<Scalar>& x,
              NodeVector<Scalar>& r, const Threads& threads);

/// Sum of squares of |A| |x| + |b|, entry by entry: times the unit round-off squared, the least |b - A x|^2 that double
/// precision can be asked for.
double absolute_product_square(const BlockMatrixd& A, const NodeVector<double>& b, const NodeVector<double>& x,
                               const Threads& threads);

/// a . b, summed in double in the order of chunks.
double dot(const NodeVector<double>& a, const NodeVector<double>& b, const Threads& threads);

/// y += factor x.
void add_scaled(double factor, const NodeVector<double>& x, NodeVector<double>& y, const Threads& threads);

/// y += factor x; returns y . y.
double add_scaled_and_square(double factor, const NodeVector<double>& x, NodeVector<double>& y, const Threads& threads);

/// y = x + factor y.
void scale_and_add(double factor, const NodeVector<double>& x, NodeVector<double>& y, const Threads& threads);

/// Between three and four lanes a node.
void pack(std::span<const Vec3> from, NodeVector<double>& to);
void unpack(const NodeVector<double>& from, std::span<Vec3> to);

}  // namespace softreel
