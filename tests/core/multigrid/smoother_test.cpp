// All smoothers behind one interface, and the spectrum that the polynomial one needs.
#include "core/multigrid/smoother.h"

#include <gtest/gtest.h>

#include "core/multigrid/chebyshev.h"
#include "core/multigrid/gauss_seidel.h"
#include "tests/core/multigrid/finest_level.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using test_support::Finest;
using test_support::random_vector;

constexpr SmootherKind kKinds[] = {SmootherKind::GaussSeidel, SmootherKind::OneWayGaussSeidel, SmootherKind::Chebyshev};

std::unique_ptr<Smoother<double>> make(SmootherKind kind, const Finest& finest) {
  MultigridParams params;
  params.smoother = kind;
  params.chebyshev_degree = 3;
  return make_smoother<double>(params, finest.hierarchy.levels[0], finest.matrix);
}

/// Largest difference of the three lanes that count.
double difference(const NodeVector<double>& a, const NodeVector<double>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (k % 4 < 3) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

double norm(const NodeVector<double>& a) {
  double square = 0;
  for (std::size_t k = 0; k < a.size(); ++k) square += k % 4 < 3 ? a[k] * a[k] : 0;
  return std::sqrt(square);
}

TEST(Smoother, KnowsTheResidualOfItsResult) {
  Finest finest;
  const Threads threads(1);
  for (const SmootherKind kind : kKinds) {
    const auto smoother = make(kind, finest);
    ASSERT_TRUE(smoother->update(threads));
    const NodeVector<double> b = random_vector(finest.matrix.pattern.rows(), 1);
    for (const int sweeps : {1, 3}) {
      NodeVector<double> x(b.size(), 0), r(b.size(), 0), expected(b.size(), 0);
      smoother->smooth_from_zero(sweeps, b, x, r, threads);
      smoother->find_residual(b, x, expected, threads);
      EXPECT_LE(difference(r, expected), 1e-12);
      smoother->smooth(sweeps, b, x, threads);
      smoother->find_residual(b, x, expected, threads);
      smoother->find_smoothed_residual(b, x, r, threads);
      EXPECT_LE(difference(r, expected), 1e-12);
    }
  }
}

TEST(Smoother, FromZeroEqualsTheGeneralSweepFromZero) {
  Finest finest;
  const Threads threads(1);
  for (const SmootherKind kind : {SmootherKind::GaussSeidel, SmootherKind::Chebyshev}) {
    const auto smoother = make(kind, finest);
    ASSERT_TRUE(smoother->update(threads));
    const NodeVector<double> b = random_vector(finest.matrix.pattern.rows(), 2);
    NodeVector<double> x(b.size(), 0), y(b.size(), 0), r(b.size(), 0);
    smoother->smooth_from_zero(1, b, x, r, threads);
    smoother->smooth(1, b, y, threads);
    EXPECT_LE(difference(x, y), 1e-18);
    EXPECT_GT(norm(x), 0);
  }
}

TEST(GaussSeidel, LengthensSeveralSweepsByTheirWeights) {
  Finest finest;
  const Threads threads(1);
  const auto smoother = make(SmootherKind::GaussSeidel, finest);
  ASSERT_TRUE(smoother->update(threads));
  const NodeVector<double> b = random_vector(finest.matrix.pattern.rows(), 5);
  NodeVector<double> x(b.size(), 0), y(b.size(), 0), swept(b.size(), 0), r(b.size(), 0);
  for (const double weight : sweep_weights(3)) {
    swept = y;
    smoother->smooth(1, b, swept, threads);
    for (std::size_t k = 0; k < y.size(); ++k) y[k] += weight * (swept[k] - y[k]);
  }
  smoother->smooth_from_zero(3, b, x, r, threads);
  EXPECT_LE(difference(x, y), 1e-12 * norm(y));
  EXPECT_GT(difference(x, swept), 1e-3 * norm(y)) << "so weights matter here";
}

TEST(GaussSeidel, HasWeightsThatDampAllOfTheSpectrum) {
  EXPECT_EQ(sweep_weights(1), std::vector<double>{1.0});
  for (const int sweeps : {2, 3, 5}) {
    double slope = 0, worst = 0;
    for (const double weight : sweep_weights(sweeps)) slope += weight;
    EXPECT_GT(slope, 1.5 * sweeps) << "what is smoothed badly is damped more than by plain sweeps";
    for (double t = 1.0 / sweeps; t <= 1; t += 1e-3) {
      double left = 1;
      for (const double weight : sweep_weights(sweeps)) left *= 1 - weight * t;
      worst = std::max(worst, std::abs(left));
    }
    EXPECT_LT(worst, 0.3) << sweeps;
  }
}

TEST(Smoother, LeavesTheSolutionAlone) {
  Finest finest;
  const Threads threads(1);
  for (const SmootherKind kind : kKinds) {
    const auto smoother = make(kind, finest);
    ASSERT_TRUE(smoother->update(threads));
    const NodeVector<double> exact = random_vector(finest.matrix.pattern.rows(), 3), zero(exact.size(), 0);
    NodeVector<double> b(exact.size(), 0), x = exact;
    smoother->find_residual(zero, exact, b, threads);
    for (double& value : b) value = -value;
    smoother->smooth(1, b, x, threads);
    EXPECT_LE(difference(x, exact), 1e-12);
  }
}

TEST(Smoother, RemovesRoughErrors) {
  Finest finest;
  const Threads threads(1);
  const NodeVector<double> error = random_vector(finest.matrix.pattern.rows(), 4), zero(error.size(), 0);
  for (const SmootherKind kind : kKinds) {
    const auto smoother = make(kind, finest);
    ASSERT_TRUE(smoother->update(threads));
    NodeVector<double> x = error, before(error.size(), 0), after(error.size(), 0);
    smoother->find_residual(zero, x, before, threads);
    smoother->smooth(1, zero, x, threads);
    smoother->find_residual(zero, x, after, threads);
    EXPECT_LE(norm(after), 0.3 * norm(before)) << static_cast<int>(kind);
  }
}

TEST(Smoother, RefusesABlockThatIsNotPositive) {
  Finest finest;
  finest.matrix.block(finest.hierarchy.levels[0].diagonal[5])[4] = -1;
  for (const SmootherKind kind : kKinds) EXPECT_FALSE(make(kind, finest)->update(Threads(1)));
}

/// Largest eigenvalue of D^-1 A, D the diagonal blocks.
double largest_eigenvalue(const Finest& finest) {
  const Index n = finest.matrix.pattern.rows();
  Eigen::MatrixXd A = test_support::dense(finest.system.matrix), D = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Index i = 0; i < n; ++i) D.block<3, 3>(3 * i, 3 * i) = A.block<3, 3>(3 * i, 3 * i);
  return test_support::generalized_eigenpairs(A, D).values.maxCoeff();
}

TEST(Chebyshev, BoundsTheSpectrumFromAboveAndClosely) {
  Finest finest;
  const double exact = largest_eigenvalue(finest);
  double bounds[2];
  for (const int count : {1, 4}) {
    Chebyshev<double> smoother(finest.hierarchy.levels[0], finest.matrix, 2);
    ASSERT_TRUE(smoother.update(Threads(count)));
    EXPECT_GE(smoother.largest_eigenvalue(), exact);
    EXPECT_LE(smoother.largest_eigenvalue(), 1.3 * exact);
    bounds[count / 4] = smoother.largest_eigenvalue();
  }
  EXPECT_EQ(bounds[0], bounds[1]);
}

TEST(Chebyshev, BoundsTheSpectrumOfDiagonalBlocks) {
  Finest finest;
  const LatticeLevel& level = finest.hierarchy.levels[0];
  std::fill(finest.matrix.values.begin(), finest.matrix.values.end(), 0.0);
  for (const std::int64_t block : level.diagonal)
    for (int k = 0; k < 9; k += 4) finest.matrix.block(block)[k] = 7;
  Chebyshev<double> smoother(level, finest.matrix, 2);
  ASSERT_TRUE(smoother.update(Threads(1)));
  EXPECT_GE(smoother.largest_eigenvalue(), 1);
  EXPECT_LE(smoother.largest_eigenvalue(), 1.1);
}

}  // namespace
}  // namespace softreel
