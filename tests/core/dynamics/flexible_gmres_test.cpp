#include "core/dynamics/flexible_gmres.h"

#include <random>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "tests/support/dense_algebra.h"

namespace softreel {
namespace {

constexpr std::size_t kNodes = 10;

Eigen::VectorXd flat(std::span<const Vec3> vectors) {
  Eigen::VectorXd result(3 * static_cast<Eigen::Index>(vectors.size()));
  for (std::size_t i = 0; i < vectors.size(); ++i) result.segment<3>(3 * static_cast<Eigen::Index>(i)) = vectors[i];
  return result;
}

VectorMap product_with(const Eigen::MatrixXd& A) {
  return [A](std::span<const Vec3> in, std::span<Vec3> out) {
    const Eigen::VectorXd product = A * flat(in);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = product.segment<3>(3 * static_cast<Eigen::Index>(i));
  };
}

/// Neither symmetric nor definite, and its symmetric part, shifted, as a preconditioner.
struct System {
  System() {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    A = Eigen::MatrixXd::Identity(3 * kNodes, 3 * kNodes);
    for (double& entry : A.reshaped()) entry += 0.3 * normal(random);
    b.resize(kNodes);
    for (Vec3& v : b) v = Vec3(normal(random), normal(random), normal(random));
    const Eigen::MatrixXd near = 0.5 * (A + A.transpose()) + 3 * Eigen::MatrixXd::Identity(3 * kNodes, 3 * kNodes);
    precondition = product_with(test_support::solve(near, Eigen::MatrixXd::Identity(near.rows(), near.cols())));
  }
  Eigen::MatrixXd A;
  std::vector<Vec3> b;
  VectorMap precondition;
};

TEST(SolveByGmres, SolvesWhatIsNotSymmetric) {
  const System system;
  std::vector<Vec3> x(kNodes);
  const GmresReport report = solve_by_gmres(product_with(system.A), system.precondition, system.b, 1e-10, 40, x);
  EXPECT_LE(report.residual, 1e-10);
  EXPECT_LE(report.iterations, static_cast<int>(3 * kNodes)) << "exact after as many as there are unknowns";
  EXPECT_LT((flat(x) - test_support::solve(system.A, flat(system.b))).norm(), 1e-7 * flat(x).norm());
}

TEST(SolveByGmres, GivesTheResidualOfItsBestWhereItEndsEarly) {
  const System system;
  double before = 1;
  for (const int most : {2, 5, 10, 20}) {
    std::vector<Vec3> x(kNodes);
    const GmresReport report = solve_by_gmres(product_with(system.A), system.precondition, system.b, 0, most, x);
    EXPECT_EQ(report.iterations, most);
    EXPECT_NEAR((flat(system.b) - system.A * flat(x)).norm() / flat(system.b).norm(), report.residual, 1e-12);
    EXPECT_LT(report.residual, before);
    before = report.residual;
  }
}

TEST(SolveByGmres, AllowsAPreconditionerThatChanges) {
  const System system;
  std::vector<Vec3> x(kNodes);
  int calls = 0;
  const VectorMap changing = [&](std::span<const Vec3> in, std::span<Vec3> out) {
    system.precondition(in, out);
    if (++calls % 2 == 0) std::copy(in.begin(), in.end(), out.begin());
  };
  EXPECT_LE(solve_by_gmres(product_with(system.A), changing, system.b, 1e-8, 40, x).residual, 1e-8);
  EXPECT_LT((flat(system.b) - system.A * flat(x)).norm(), 1e-7 * flat(system.b).norm());
}

TEST(SolveByGmres, AnswersZeroWithZero) {
  const System system;
  std::vector<Vec3> x(kNodes, Vec3(1, 1, 1));
  EXPECT_EQ(
      solve_by_gmres(product_with(system.A), system.precondition, std::vector<Vec3>(kNodes, Vec3::Zero()), 1e-8, 9, x)
          .iterations,
      0);
  EXPECT_TRUE(flat(x).isZero(0));
}

}  // namespace
}  // namespace softreel
