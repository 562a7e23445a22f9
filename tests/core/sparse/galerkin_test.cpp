// The three forms of E = R K R^T: eq. (9), the paper's stream (Algorithm 1) and the symmetric gather.
#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "core/sparse/block_kernels.h"
#include "core/sparse/galerkin_gather.h"
#include "core/sparse/galerkin_product.h"
#include "core/sparse/galerkin_stream.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

/// Each fine node gets up to four random coarse parents.
WeightMatrix random_prolongation(Index fine, Index coarse, std::mt19937& random) {
  std::uniform_int_distribution<Index> parent(0, coarse - 1);
  std::uniform_real_distribution<double> weight(0.1, 1);
  WeightMatrix result;
  result.columns = coarse;
  for (Index i = 0; i < fine; ++i) {
    std::vector<Index> parents{parent(random), parent(random), parent(random), parent(random)};
    std::sort(parents.begin(), parents.end());
    parents.erase(std::unique(parents.begin(), parents.end()), parents.end());
    for (const Index j : parents) {
      result.column_indices.push_back(j);
      result.weights.push_back(weight(random));
    }
    result.row_offsets.push_back(result.entries());
  }
  return result;
}

template <typename Scalar>
struct Products {
  BlockMatrix<Scalar> naive, stream, gather;
};

template <typename Scalar>
Products<Scalar> all_products(const BlockMatrix<Scalar>& K, const WeightMatrix& Rt) {
  const WeightMatrix R = transpose(Rt);
  BlockMatrix<Scalar> E{galerkin_pattern(K.pattern, R, Rt), {}};
  reserve_values(E);
  Products<Scalar> products{E, E, E};
  galerkin_product(K, R, products.naive);
  GalerkinStream<Scalar>(K.pattern, Rt, E.pattern).run(K, products.stream);
  GalerkinGather<Scalar>(K.pattern, Rt, E.pattern).run(K, products.gather, Threads(2));
  return products;
}

template <typename Scalar>
BlockMatrix<Scalar> cast(const BlockMatrixd& K) {
  BlockMatrix<Scalar> result{K.pattern, {}};
  for (const double value : K.values) result.values.push_back(static_cast<Scalar>(value));
  return result;
}

template <typename Scalar>
double largest_difference(const BlockMatrix<Scalar>& a, const BlockMatrix<Scalar>& b) {
  double difference = 0, largest = 0;
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    difference = std::max(difference, std::abs(static_cast<double>(a.values[k] - b.values[k])));
    largest = std::max(largest, std::abs(static_cast<double>(a.values[k])));
  }
  return difference / largest;
}

BlockMatrixd elastic_matrix() {
  const TetMesh mesh = test_support::make_box({4, 3, 2}, 0.5);
  return test_support::assemble(mesh, {}, [](const Vec3& x) { return x[0] < 0.1; }).matrix;
}

TEST(Galerkin, ThreeFormsAgreeToRoundOff) {
  std::mt19937 random(1);
  const BlockMatrixd K = elastic_matrix();
  const WeightMatrix Rt = random_prolongation(K.pattern.rows(), 12, random);
  const auto exact = all_products<double>(K, Rt);
  EXPECT_LE(largest_difference(exact.naive, exact.stream), 1e-14);
  EXPECT_LE(largest_difference(exact.naive, exact.gather), 1e-14);
  const auto rounded = all_products<float>(cast<float>(K), Rt);
  EXPECT_LE(largest_difference(rounded.naive, rounded.stream), 4e-6);
  EXPECT_LE(largest_difference(rounded.naive, rounded.gather), 4e-6);
}

TEST(Galerkin, EqualsTheDenseProduct) {
  std::mt19937 random(2);
  const BlockMatrixd K = elastic_matrix();
  const WeightMatrix Rt = random_prolongation(K.pattern.rows(), 9, random);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(3 * K.pattern.rows(), 3 * 9);
  for (Index i = 0; i < Rt.rows(); ++i)
    for (std::int64_t e = Rt.row_offsets[static_cast<std::size_t>(i)];
         e < Rt.row_offsets[static_cast<std::size_t>(i) + 1]; ++e)
      P.block<3, 3>(3 * i, 3 * Rt.column_indices[static_cast<std::size_t>(e)]) =
          Rt.weights[static_cast<std::size_t>(e)] * Mat3::Identity();
  const Eigen::MatrixXd expected = P.transpose() * test_support::dense(K) * P;
  const auto products = all_products<double>(K, Rt);
  for (const BlockMatrixd* E : {&products.naive, &products.stream, &products.gather})
    EXPECT_LE((test_support::dense(*E) - expected).norm(), 1e-13 * expected.norm());
}

TEST(Galerkin, GatherIsExactlySymmetric) {
  std::mt19937 random(3);
  const BlockMatrixd K = elastic_matrix();
  const auto products = all_products<float>(cast<float>(K), random_prolongation(K.pattern.rows(), 10, random));
  const BlockMatrixf& E = products.gather;
  for (Index i = 0; i < E.pattern.rows(); ++i)
    for (Index j = 0; j < E.pattern.rows(); ++j) {
      const std::int64_t b = E.pattern.find(i, j), mirror = E.pattern.find(j, i);
      ASSERT_EQ(b >= 0, mirror >= 0);
      if (b < 0) continue;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(E.block(b)[3 * r + c], E.block(mirror)[3 * c + r]);
    }
}

TEST(Galerkin, GatherHasTheSameBitsAtAnyThreadCount) {
  std::mt19937 random(4);
  const BlockMatrixf K = cast<float>(elastic_matrix());
  const WeightMatrix Rt = random_prolongation(K.pattern.rows(), 40, random);
  BlockMatrixf one{galerkin_pattern(K.pattern, transpose(Rt), Rt), {}};
  reserve_values(one);
  BlockMatrixf four = one;
  const GalerkinGather<float> gather(K.pattern, Rt, one.pattern);
  gather.run(K, one, Threads(1));
  gather.run(K, four, Threads(4));
  EXPECT_EQ(one.values, four.values);
  // Nor does the order in which the blocks are made matter.
  std::vector<Index> rank(static_cast<std::size_t>(K.pattern.rows()));
  std::iota(rank.begin(), rank.end(), 0);
  std::shuffle(rank.begin(), rank.end(), random);
  BlockMatrixf reordered{one.pattern, {}};
  reserve_values(reordered);
  GalerkinGather<float>(K.pattern, Rt, one.pattern, rank).run(K, reordered, Threads(4));
  EXPECT_EQ(one.values, reordered.values);
}

// One block of K: the traversal must start at the first entry, which the paper's step 1 would skip.
TEST(GalerkinStream, StartsAtTheFirstBlock) {
  BlockMatrixd K{{1, {0, 1}, {0}}, {1, 2, 3, 4, 5, 6, 7, 8, 9}};
  const WeightMatrix Rt{1, {0, 1}, {0}, {0.5}};
  BlockMatrixd E{{1, {0, 1}, {0}}, {}};
  reserve_values(E);
  const GalerkinStream<double> stream(K.pattern, Rt, E.pattern);
  stream.run(K, E);
  EXPECT_EQ(stream.control(), std::vector<std::uint8_t>{0x81});
  for (std::size_t k = 0; k < 9; ++k) EXPECT_EQ(E.values[k], 0.25 * K.values[k]);
}

// 12 parents each: the one block of K is scattered 144 times, which takes two control bytes.
TEST(GalerkinStream, ContinuesInASecondControlByteAfter127Pairs) {
  BlockMatrixd K{{1, {0, 1}, {0}}, {2, 0, 0, 0, 2, 0, 0, 0, 2}};
  WeightMatrix Rt{12, {0, 12}, {}, {}};
  for (Index j = 0; j < 12; ++j) {
    Rt.column_indices.push_back(j);
    Rt.weights.push_back(1 + j);
  }
  BlockMatrixd E{galerkin_pattern(K.pattern, transpose(Rt), Rt), {}};
  reserve_values(E);
  const GalerkinStream<double> stream(K.pattern, Rt, E.pattern);
  stream.run(K, E);
  EXPECT_EQ(stream.control(), (std::vector<std::uint8_t>{0xff, 17}));
  for (Index i = 0; i < 12; ++i)
    for (Index j = 0; j < 12; ++j) EXPECT_EQ(E.block(E.pattern.find(i, j))[4], 2.0 * (1 + i) * (1 + j));
}

TEST(GalerkinStream, HasOneNextBitPerBlockEvenWhereNothingIsScattered) {
  const BlockMatrixd K = elastic_matrix();
  // Only the first fine node has a parent.
  WeightMatrix Rt{1, std::vector<std::int64_t>(static_cast<std::size_t>(K.pattern.rows()) + 1, 1), {0}, {1.0}};
  Rt.row_offsets[0] = 0;
  BlockMatrixd E{galerkin_pattern(K.pattern, transpose(Rt), Rt), {}};
  reserve_values(E);
  const GalerkinStream<double> stream(K.pattern, Rt, E.pattern);
  stream.run(K, E);
  std::int64_t next_bits = 0;
  for (const std::uint8_t control : stream.control()) next_bits += control >> 7;
  EXPECT_EQ(next_bits, K.pattern.blocks());
  for (std::size_t k = 0; k < 9; ++k) EXPECT_EQ(E.values[k], K.block(K.pattern.find(0, 0))[k]);
}

TEST(WeightMatrix, TransposedTwiceIsItself) {
  std::mt19937 random(6);
  const WeightMatrix matrix = random_prolongation(50, 8, random);
  const WeightMatrix twice = transpose(transpose(matrix));
  EXPECT_EQ(twice.columns, matrix.columns);
  EXPECT_EQ(twice.row_offsets, matrix.row_offsets);
  EXPECT_EQ(twice.column_indices, matrix.column_indices);
  EXPECT_EQ(twice.weights, matrix.weights);
}

}  // namespace
}  // namespace softreel
