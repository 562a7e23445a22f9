#include "core/dynamics/linear_system.h"

#include <algorithm>

namespace softreel {
namespace {

constexpr std::int64_t kSystemRowGrain = 512;

/// Mean diagonal entry of the rows that are not held; 1 if all are.
double mean_diagonal(const BlockMatrixd& matrix, std::span<const std::uint8_t> held, const Threads& threads) {
  const BlockPattern& pattern = matrix.pattern;
  double rows = 0;
  for (const std::uint8_t h : held) rows += h == 0 ? 1 : 0;
  const double sum = threads.sum_chunks(pattern.rows(), kSystemRowGrain, [&](std::int64_t begin, std::int64_t end) {
    double part = 0;
    for (auto row = static_cast<std::size_t>(begin); row < static_cast<std::size_t>(end); ++row) {
      if (held[row] != 0) continue;
      const double* block = matrix.block(pattern.find(static_cast<Index>(row), static_cast<Index>(row)));
      part += block[0] + block[4] + block[8];
    }
    return part;
  });
  return rows > 0 && sum > 0 ? sum / (3 * rows) : 1.0;
}

}  // namespace

void multiply(const BlockMatrixd& matrix, std::span<const Vec3> x, std::span<Vec3> product, const Threads& threads) {
  const BlockPattern& pattern = matrix.pattern;
  threads.for_chunks(pattern.rows(), kSystemRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto row = static_cast<std::size_t>(begin); row < static_cast<std::size_t>(end); ++row) {
      Vec3 sum = Vec3::Zero();
      for (std::int64_t b = pattern.row_offsets[row]; b < pattern.row_offsets[row + 1]; ++b) {
        const double* k = matrix.block(b);
        const Vec3& v = x[static_cast<std::size_t>(pattern.column_indices[static_cast<std::size_t>(b)])];
        sum.x() += k[0] * v.x() + k[1] * v.y() + k[2] * v.z();
        sum.y() += k[3] * v.x() + k[4] * v.y() + k[5] * v.z();
        sum.z() += k[6] * v.x() + k[7] * v.y() + k[8] * v.z();
      }
      product[row] = sum;
    }
  });
}

void eliminate_held(BlockMatrixd& matrix, std::span<const std::uint8_t> held, const Threads& threads) {
  const double diagonal = mean_diagonal(matrix, held, threads);
  const BlockPattern& pattern = matrix.pattern;
  threads.for_chunks(pattern.rows(), kSystemRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto row = static_cast<std::size_t>(begin); row < static_cast<std::size_t>(end); ++row)
      for (std::int64_t b = pattern.row_offsets[row]; b < pattern.row_offsets[row + 1]; ++b) {
        const auto column = static_cast<std::size_t>(pattern.column_indices[static_cast<std::size_t>(b)]);
        if (held[row] == 0 && held[column] == 0) continue;
        double* block = matrix.block(b);
        std::fill(block, block + 9, 0.0);
        if (row == column) block[0] = block[4] = block[8] = diagonal;
      }
  });
}

}  // namespace softreel
