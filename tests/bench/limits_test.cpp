#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/benchmark/limits/bending_bar.h"
#include "tests/benchmark/limits/cost_curve.h"
#include "tests/support/elastic_box.h"

namespace softreel::bench {
namespace {

constexpr TetRemedy kAll[] = {TetRemedy::None, TetRemedy::Quadratic, TetRemedy::NodalPressure, TetRemedy::NodalStrain};

/// A box with hardly two equal angles.
TetMesh skewed_box() {
  TetMesh mesh = test_support::make_box({2, 2, 2}, 0.5);
  for (Vec3& x : mesh.nodes) x += 0.05 * Vec3(std::sin(5 * x.y()), std::sin(4 * x.z() + 1), std::sin(6 * x.x() + 2));
  return mesh;
}

TEST(TetRemedies, EveryStrainIsExactForLinearDisplacements) {
  const TetMesh mesh = skewed_box();
  for (const TetRemedy remedy : kAll) {
    const Discretization discretization = discretize(mesh, remedy, Lame::of(1, 0.3));
    for (const StrainCell& cell : discretization.cells)
      for (const StrainPoint& point : cell.points) {
        Mat3 F = Mat3::Zero();
        for (std::size_t i = 0; i < cell.nodes.size(); ++i)
          F += discretization.nodes[static_cast<std::size_t>(cell.nodes[i])] *
               point.gradients.col(static_cast<Eigen::Index>(i)).transpose();
        ASSERT_LT((F - Mat3::Identity()).norm(), 1e-12) << name_of(remedy);
        ASSERT_LT(point.gradients.rowwise().sum().norm(), 1e-11) << name_of(remedy);
      }
  }
}

TEST(TetRemedies, TakeTheEnergyOfUniformStrainAndTheVolumeOnce) {
  const TetMesh mesh = skewed_box();
  double volume = 0;
  for (const Tet& tet : mesh.tets) {
    const auto at = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
    volume += tet_volume(at(0), at(1), at(2), at(3));
  }
  const Lame material = Lame::of(3, 0.45);
  for (const TetRemedy remedy : kAll) {
    double lambda = 0, mu = 0, loaded = 0;
    for (const StrainCell& cell : discretize(mesh, remedy, material).cells)
      for (const StrainPoint& point : cell.points) {
        lambda += point.weight * point.material.lambda;
        mu += point.weight * point.material.mu;
        if (point.values.size() > 0) loaded += point.weight * point.values.sum();
      }
    EXPECT_NEAR(lambda, volume * material.lambda, 1e-10) << name_of(remedy);
    EXPECT_NEAR(mu, volume * material.mu, 1e-10) << name_of(remedy);
    EXPECT_NEAR(loaded, volume, 1e-12) << name_of(remedy);
  }
}

/// u = sin(pi x) sin(pi y) sin(pi z) c on a unit cube that is held all round, by the body force that belongs to it.
class Manufactured {
 public:
  Vec3 displacement(const Vec3& x) const { return s(x.x()) * s(x.y()) * s(x.z()) * direction_; }
  /// -(lambda + mu) grad div u - mu laplace u.
  Vec3 force(const Vec3& x) const {
    const double k = std::numbers::pi * std::numbers::pi;
    Mat3 hessian;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int rest = 3 - i - j;
        hessian(i, j) = i == j ? -k * s(x.x()) * s(x.y()) * s(x.z()) : k * c(x[i]) * c(x[j]) * s(x[rest]);
      }
    return -(material.lambda + material.mu) * hessian * direction_ + 3 * k * material.mu * displacement(x);
  }
  Lame material = Lame::of(1, 0.3);

 private:
  static double s(double t) { return std::sin(std::numbers::pi * t); }
  static double c(double t) { return std::cos(std::numbers::pi * t); }
  Vec3 direction_ = Vec3(1, -0.5, 0.7);
};

/// Root mean square error at the nodes.
double manufactured_error(TetRemedy remedy, Index cubes) {
  const Manufactured problem;
  const Discretization discretization =
      discretize(test_support::make_box({cubes, cubes, cubes}, 1.0 / cubes), remedy, problem.material);
  const auto held = [](const Vec3& x) {
    const bool on_face = x.minCoeff() < 1e-9 || x.maxCoeff() > 1 - 1e-9;
    return std::array<bool, 3>{on_face, on_face, on_face};
  };
  const HeldDisplacements answer = solve_statics(discretization, held, [&](const Vec3& x) { return problem.force(x); });
  double square = 0;
  for (std::size_t i = 0; i < discretization.nodes.size(); ++i)
    square += (answer.displacements[i] - problem.displacement(discretization.nodes[i])).squaredNorm();
  return std::sqrt(square / static_cast<double>(discretization.nodes.size()));
}

double order(TetRemedy remedy, Index coarse, Index fine) {
  return std::log(manufactured_error(remedy, coarse) / manufactured_error(remedy, fine)) /
         std::log(static_cast<double>(fine) / coarse);
}

TEST(TetRemedies, ConvergeToASmoothSolutionWithTheirOrders) {
  const double linear = order(TetRemedy::None, 4, 8);
  EXPECT_GT(linear, 1.7);
  EXPECT_GT(order(TetRemedy::Quadratic, 2, 4), linear + 0.7);
  EXPECT_GT(order(TetRemedy::NodalPressure, 4, 8), 1.5);
  EXPECT_GT(order(TetRemedy::NodalStrain, 4, 8), 1.5);
}

TEST(BendingBar, PolynomialsAgreeWithTimoshenkoAndWithEachOther) {
  const double shear_modulus = Lame::of(kBarModulus, 0.3).mu, load = kBarDensity * 9.81, height = 0.25;
  const double timoshenko = load * (12 / (8 * kBarModulus * height * height) + 1 / (2 * 0.85 * shear_modulus));
  const double coarse = bend_bar_by_polynomials(3, 0.3).tip, fine = bend_bar_by_polynomials(4, 0.3).tip;
  EXPECT_NEAR(fine, timoshenko, 0.03 * timoshenko);
  EXPECT_NEAR(fine, coarse, 5e-4 * fine);
}

/// Their spaces lie in each other and their energies are exact, so each finer one gives way more, and none as much as
/// the truth.
TEST(BendingBar, ConformingTetrahedraSagLessThanTheTruth) {
  const double truth = bend_bar_by_polynomials(4, 0.45).tip;
  for (const TetRemedy remedy : {TetRemedy::None, TetRemedy::Quadratic}) {
    const double coarse = bend_bar(1, remedy, 0.45).tip, fine = bend_bar(2, remedy, 0.45).tip;
    EXPECT_LT(coarse, fine) << name_of(remedy);
    EXPECT_LT(fine, truth) << name_of(remedy);
  }
}

TEST(BendingBar, NodalPressureDoesNotLockWhereLinearTetrahedraDo) {
  const double truth = bend_bar_by_polynomials(3, 0.499).tip;
  const double linear = bend_bar(4, TetRemedy::None, 0.499).tip / truth;
  const double averaged = bend_bar(4, TetRemedy::NodalPressure, 0.499).tip / truth;
  EXPECT_LT(linear, 0.4);
  EXPECT_GT(averaged, 0.85);
  EXPECT_GT((1 - linear) / std::abs(1 - averaged), 5);
  // It is incompressibility that locks them: without it the same mesh gives most of the sag.
  const double plain_truth = bend_bar_by_polynomials(3, 0).tip;
  EXPECT_GT(bend_bar(4, TetRemedy::None, 0).tip / plain_truth, 0.9);
}

TEST(CostCurve, FollowsPowerLaws) {
  const CostCurve curve{{10, 100, 1000}, {1, 0.1, 0.01}};
  EXPECT_NEAR(curve.error_at(31.6227766), 0.316227766, 1e-6);
  EXPECT_NEAR(curve.error_at(1000), 0.01, 1e-12);
  EXPECT_TRUE(std::isnan(curve.error_at(9)));
  EXPECT_TRUE(std::isnan(curve.error_at(1001)));
  bool extrapolated = true;
  EXPECT_NEAR(curve.cost_for(0.05, extrapolated), 200, 1e-6);
  EXPECT_FALSE(extrapolated);
  EXPECT_NEAR(curve.cost_for(1e-3, extrapolated), 10000, 1e-6);
  EXPECT_TRUE(extrapolated);
}

TEST(CostCurve, CountsTheCostFromWhichTheErrorStaysSmall) {
  const CostCurve dips{{1, 10, 100, 1000}, {1, 0.01, 1, 0.01}}, flat{{1, 10}, {1, 1}};
  bool extrapolated = false;
  EXPECT_NEAR(dips.cost_for(0.1, extrapolated), 316.227766, 1e-4);
  EXPECT_FALSE(extrapolated);
  EXPECT_TRUE(std::isinf(flat.cost_for(0.1, extrapolated)));
  EXPECT_TRUE(extrapolated);
}

}  // namespace
}  // namespace softreel::bench
