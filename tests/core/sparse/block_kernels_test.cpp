#include "core/sparse/block_kernels.h"

#include <random>

#include <gtest/gtest.h>

#include "core/sparse/row_product_simd.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

constexpr int kSizes[] = {1, 2, 3, 5, 17, 600};

/// A band matrix with random blocks.
template <typename Scalar>
BlockMatrix<Scalar> random_matrix(Index rows, std::mt19937& random) {
  BlockMatrix<Scalar> matrix;
  matrix.pattern.columns = rows;
  std::uniform_real_distribution<Scalar> value(-1, 1);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < rows; ++j)
      if (i == j || (i + j) % 7 == 3 || std::abs(i - j) == 1) matrix.pattern.column_indices.push_back(j);
    matrix.pattern.row_offsets.push_back(matrix.pattern.blocks());
  }
  for (std::int64_t k = 0; k < 9 * matrix.pattern.blocks(); ++k) matrix.values.push_back(value(random));
  return matrix;
}

template <typename Scalar>
NodeVector<Scalar> random_vector(Index rows, std::mt19937& random) {
  std::uniform_real_distribution<Scalar> value(-1, 1);
  NodeVector<Scalar> vector(static_cast<std::size_t>(4 * rows), 0);
  for (Index i = 0; i < rows; ++i)
    for (Index c = 0; c < 3; ++c) vector[static_cast<std::size_t>(4 * i + c)] = value(random);
  return vector;
}

/// A x entry by entry.
template <typename Scalar>
NodeVector<Scalar> plain_product(const BlockMatrix<Scalar>& A, const NodeVector<Scalar>& x, bool column_major) {
  NodeVector<Scalar> y(x.size(), 0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(A.pattern.rows()); ++i)
    for (std::int64_t b = A.pattern.row_offsets[i]; b < A.pattern.row_offsets[i + 1]; ++b)
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c)
          y[4 * i + r] += A.block(b)[column_major ? 3 * c + r : 3 * r + c] *
                          x[4 * static_cast<std::size_t>(A.pattern.column_indices[static_cast<std::size_t>(b)]) + c];
  return y;
}

template <typename Scalar>
class BlockKernels : public ::testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(BlockKernels, Scalars);

TYPED_TEST(BlockKernels, MultiplyAgreesWithPlainLoopsOnAwkwardSizes) {
  using Scalar = TypeParam;
  const Threads threads(2);
  std::mt19937 random(1);
  const Scalar tolerance = 200 * std::numeric_limits<Scalar>::epsilon();
  for (const Index rows : kSizes) {
    const BlockMatrix<Scalar> A = random_matrix<Scalar>(rows, random);
    const NodeVector<Scalar> x = random_vector<Scalar>(rows, random);
    NodeVector<Scalar> y(x.size(), 7);
    multiply(A, x, y, threads);
    const NodeVector<Scalar> expected = plain_product(A, x, false);
    for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(y[k], expected[k], tolerance) << rows;
  }
}

TYPED_TEST(BlockKernels, ColumnMajorProductAgreesWithPlainLoops) {
  using Scalar = TypeParam;
  std::mt19937 random(2);
  const Scalar tolerance = 200 * std::numeric_limits<Scalar>::epsilon();
  for (const Index rows : kSizes) {
    BlockMatrix<Scalar> A = random_matrix<Scalar>(rows, random);
    const NodeVector<Scalar> x = random_vector<Scalar>(rows, random);
    const NodeVector<Scalar> expected = plain_product(A, x, true);
    A.values.resize(A.values.size() + 3);
    for (std::size_t i = 0; i < static_cast<std::size_t>(rows); ++i) {
      const NodeLanes<Scalar> y =
          column_major_row_product(A.values.data(), A.pattern.column_indices.data(), A.pattern.row_offsets[i],
                                   A.pattern.row_offsets[i + 1], x.data());
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(y[static_cast<Index>(c)], expected[4 * i + c], tolerance);
    }
  }
}

TEST(PairedRowProduct, AgreesWithItsPlainTwinForRowsOfAnyLength) {
  std::mt19937 random(4);
  const float tolerance = 200 * std::numeric_limits<float>::epsilon();
  BlockMatrix<float> A = random_matrix<float>(40, random);
  const NodeVector<float> x = random_vector<float>(40, random);
  A.values.resize(A.values.size() + 3);
  const Index* const columns = A.pattern.column_indices.data();
  for (std::int64_t begin = 0; begin < 3; ++begin)
    for (std::int64_t end = begin; end <= A.pattern.blocks(); ++end) {
      const auto plain = column_major_row_product(A.values.data(), columns, begin, end, x.data());
      const auto paired = paired_row_product(A.values.data(), columns, begin, end, x.data());
      const auto scale = static_cast<float>(end - begin);
      for (Index c = 0; c < 3; ++c) EXPECT_NEAR(paired[c], plain[c], tolerance * (1 + scale)) << begin << " " << end;
    }
}

TYPED_TEST(BlockKernels, ResidualIsLoadMinusProduct) {
  using Scalar = TypeParam;
  const Threads threads(1);
  std::mt19937 random(3);
  const BlockMatrix<Scalar> A = random_matrix<Scalar>(40, random);
  const NodeVector<Scalar> x = random_vector<Scalar>(40, random), b = random_vector<Scalar>(40, random);
  NodeVector<Scalar> r(x.size()), y(x.size());
  residual(A, b, x, r, threads);
  multiply(A, x, y, threads);
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_EQ(r[k], b[k] - y[k]);
}

TEST(BlockKernelSums, HaveTheSameBitsAtAnyThreadCount) {
  std::mt19937 random(4);
  const BlockMatrixd A = random_matrix<double>(1700, random);
  const NodeVector<double> x = random_vector<double>(1700, random);
  NodeVector<double> y1(x.size()), y4(x.size());
  EXPECT_EQ(multiply_and_dot(A, x, y1, Threads(1)), multiply_and_dot(A, x, y4, Threads(4)));
  EXPECT_EQ(y1, y4);
  EXPECT_EQ(dot(x, y1, Threads(1)), dot(x, y1, Threads(4)));
  EXPECT_EQ(add_scaled_and_square(0.3, x, y1, Threads(1)), add_scaled_and_square(0.3, x, y4, Threads(4)));
  EXPECT_EQ(y1, y4);
}

TEST(BlockKernelSums, AgreeWithEachOther) {
  const Threads threads(1);
  std::mt19937 random(5);
  const BlockMatrixd A = random_matrix<double>(30, random);
  const NodeVector<double> x = random_vector<double>(30, random), b = random_vector<double>(30, random);
  NodeVector<double> y(x.size());
  const double product = multiply_and_dot(A, x, y, threads);
  EXPECT_DOUBLE_EQ(product, dot(x, y, threads));
  NodeVector<double> sum = b, same = x;
  const double square = add_scaled_and_square(-2, x, sum, threads);
  EXPECT_DOUBLE_EQ(square, dot(sum, sum, threads));
  scale_and_add(-0.5, x, same, threads);
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_DOUBLE_EQ(same[k], 0.5 * x[k]);
  // |A| |x| + |b| bounds |b - A x|.
  residual(A, b, x, sum, threads);
  EXPECT_GE(absolute_product_square(A, b, x, threads), dot(sum, sum, threads));
}

TEST(NodeLanes, PackAndUnpackAreInverse) {
  const std::vector<Vec3> nodes{{1, 2, 3}, {4, 5, 6}};
  NodeVector<double> packed;
  pack(nodes, packed);
  EXPECT_EQ(packed, (NodeVector<double>{1, 2, 3, 0, 4, 5, 6, 0}));
  std::vector<Vec3> back(2);
  unpack(packed, back);
  EXPECT_EQ(back, nodes);
}

}  // namespace
}  // namespace softreel
