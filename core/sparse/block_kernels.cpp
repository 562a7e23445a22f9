#include "core/sparse/block_kernels.h"

#include "core/base/check.h"

namespace softreel {
namespace {

using Lanes = NodeLanes<double>;

std::int64_t node_count(const NodeVector<double>& vector) {
  return static_cast<std::int64_t>(vector.size() / 4);
}

}  // namespace

template <typename Scalar>
void multiply(const BlockMatrix<Scalar>& A, const NodeVector<Scalar>& x, NodeVector<Scalar>& y,
              const Threads& threads) {
  const std::int64_t* const offsets = A.pattern.row_offsets.data();
  threads.for_chunks(A.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(y, i) = row_product(A, offsets[i], offsets[i + 1], x.data());
  });
}

double multiply_and_dot(const BlockMatrixd& A, const NodeVector<double>& x, NodeVector<double>& y,
                        const Threads& threads) {
  const std::int64_t* const offsets = A.pattern.row_offsets.data();
  return threads.sum_chunks(A.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    Lanes sum = Lanes::Zero();
    for (std::int64_t i = begin; i < end; ++i) {
      const Lanes product = row_product(A, offsets[i], offsets[i + 1], x.data());
      lanes(y, i) = product;
      sum += product * lanes(x, i);
    }
    return sum[0] + sum[1] + sum[2];
  });
}

template <typename Scalar>
void residual(const BlockMatrix<Scalar>& A, const NodeVector<Scalar>& b, const NodeVector<Scalar>& x,
              NodeVector<Scalar>& r, const Threads& threads) {
  const std::int64_t* const offsets = A.pattern.row_offsets.data();
  threads.for_chunks(A.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      lanes(r, i) = lanes(b, i) - row_product(A, offsets[i], offsets[i + 1], x.data());
  });
}

double absolute_product_square(const BlockMatrixd& A, const NodeVector<double>& b, const NodeVector<double>& x,
                               const Threads& threads) {
  const BlockPattern& pattern = A.pattern;
  return threads.sum_chunks(pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (std::int64_t i = begin; i < end; ++i) {
      const auto row = static_cast<std::size_t>(i);
      Vec3 total = lanes(b, i).head<3>().abs();
      for (std::int64_t k = pattern.row_offsets[row]; k < pattern.row_offsets[row + 1]; ++k) {
        const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(A.block(k));
        const Index column = pattern.column_indices[static_cast<std::size_t>(k)];
        total += block.cwiseAbs() * lanes(x, column).head<3>().abs().matrix();
      }
      sum += total.squaredNorm();
    }
    return sum;
  });
}

double dot(const NodeVector<double>& a, const NodeVector<double>& b, const Threads& threads) {
  CHECK(a.size() == b.size());
  return threads.sum_chunks(node_count(a), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    Lanes sum = Lanes::Zero();
    for (std::int64_t i = begin; i < end; ++i) sum += lanes(a, i) * lanes(b, i);
    return sum[0] + sum[1] + sum[2];
  });
}

void add_scaled(double factor, const NodeVector<double>& x, NodeVector<double>& y, const Threads& threads) {
  threads.for_chunks(node_count(x), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(y, i) += factor * lanes(x, i);
  });
}

double add_scaled_and_square(double factor, const NodeVector<double>& x, NodeVector<double>& y,
                             const Threads& threads) {
  return threads.sum_chunks(node_count(x), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    Lanes sum = Lanes::Zero();
    for (std::int64_t i = begin; i < end; ++i) {
      const Lanes value = lanes(y, i) + factor * lanes(x, i);
      lanes(y, i) = value;
      sum += value * value;
    }
    return sum[0] + sum[1] + sum[2];
  });
}

void scale_and_add(double factor, const NodeVector<double>& x, NodeVector<double>& y, const Threads& threads) {
  threads.for_chunks(node_count(x), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(y, i) = lanes(x, i) + factor * lanes(y, i);
  });
}

void pack(std::span<const Vec3> from, NodeVector<double>& to) {
  to.resize(4 * from.size());
  for (std::size_t i = 0; i < from.size(); ++i)
    lanes(to, static_cast<std::int64_t>(i)) = Lanes(from[i][0], from[i][1], from[i][2], 0);
}

void unpack(const NodeVector<double>& from, std::span<Vec3> to) {
  CHECK(from.size() == 4 * to.size());
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = lanes(from, static_cast<std::int64_t>(i)).head<3>();
}

template void multiply(const BlockMatrixf&, const NodeVector<float>&, NodeVector<float>&, const Threads&);
template void multiply(const BlockMatrixd&, const NodeVector<double>&, NodeVector<double>&, const Threads&);
template void residual(const BlockMatrixf&, const NodeVector<float>&, const NodeVector<float>&, NodeVector<float>&,
                       const Threads&);
template void residual(const BlockMatrixd&, const NodeVector<double>&, const NodeVector<double>&, NodeVector<double>&,
                       const Threads&);

}  // namespace softreel
