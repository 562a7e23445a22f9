#include "core/elasticity/element_strain.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace softreel {
namespace {

Mat3 random_rotation(std::mt19937& random) {
  std::normal_distribution<double> any;
  return Quaternion(any(random), any(random), any(random), any(random)).normalized().toRotationMatrix();
}

ElementMaterial material(double E, double nu) {
  ElementMaterial m;
  m.youngs_modulus = E;
  m.poisson_ratio = nu;
  return m;
}

TEST(DeformationGradient, CarriesRestEdgesToDeformedOnes) {
  std::mt19937 random(1);
  const std::array<Vec3, 4> rest{Vec3(0, 0, 0), Vec3(1, 0, 0.2), Vec3(0.1, 0.8, 0), Vec3(0, 0.3, 1.2)};
  Mat3 A;
  A << 1.1, 0.3, 0, -0.2, 0.8, 0.1, 0.05, 0, 1.4;
  std::array<Vec3, 4> deformed;
  for (std::size_t k = 0; k < 4; ++k) deformed[k] = A * rest[k] + Vec3(5, -3, 2);
  EXPECT_TRUE(deformation_gradient(rest, deformed).isApprox(A, 1e-13));
}

TEST(PrincipalStretches, AreThoseOfTheSymmetricFactorWhateverTheRotations) {
  std::mt19937 random(2);
  for (int k = 0; k < 100; ++k) {
    Vec3 wanted(0.4 + 0.01 * k, 0.9, 1.3);
    const Mat3 F = random_rotation(random) * wanted.asDiagonal() * random_rotation(random);
    std::sort(wanted.begin(), wanted.end());
    EXPECT_TRUE(principal_stretches(F).isApprox(wanted, 1e-7)) << k;
  }
}

TEST(PrincipalStretches, OfARotationAreOneToTheLastDigits) {
  std::mt19937 random(3);
  for (int k = 0; k < 50; ++k)
    EXPECT_LT(largest_strain(principal_stretches(random_rotation(random))), 1e-14) << "no strain in a turned element";
}

TEST(PrincipalStretches, TheSmallestOfAnInvertedElementIsNegative) {
  const Vec3 stretches = principal_stretches(Vec3(1.2, -0.3, 0.9).asDiagonal());
  EXPECT_NEAR(stretches[0], -0.3, 1e-12);
  EXPECT_NEAR(largest_strain(stretches), 1.3, 1e-12);
}

TEST(PrincipalStretches, KeepsSmallStrains) {
  const double strain = 1e-9;
  EXPECT_NEAR(largest_strain(principal_stretches(Vec3(1 + strain, 1, 1).asDiagonal())), strain, 1e-6 * strain + 3e-16);
}

TEST(VonMisesStress, OfUniaxialStressIsItsMagnitude) {
  std::mt19937 random(4);
  for (const double nu : {0.0, 0.3, 0.45})
    for (const double strain : {-0.2, -1e-3, 0.05, 0.4}) {
      // A bar pulled along x is free to thin: e = (strain, -nu strain, -nu strain), so sigma = E strain.
      const Vec3 stretches(1 + strain, 1 - nu * strain, 1 - nu * strain);
      const Mat3 F = random_rotation(random) * stretches.asDiagonal();
      EXPECT_NEAR(von_mises_stress(principal_stretches(F), material(2e5, nu)), 2e5 * std::abs(strain), 1e-2)
          << nu << " " << strain;
    }
}

TEST(VonMisesStress, OfPressureIsNone) {
  EXPECT_NEAR(von_mises_stress(Vec3::Constant(0.8), material(1e6, 0.3)), 0, 1e-6);
}

TEST(VonMisesStress, OfPureShearIsRootThreeTimesTheShear) {
  // Principal strains (g/2, 0, -g/2): tau = mu g.
  const ElementMaterial m = material(1e5, 0.25);
  const double g = 0.02;
  EXPECT_NEAR(von_mises_stress(Vec3(1 - g / 2, 1, 1 + g / 2), m), std::sqrt(3.0) * m.lame_mu() * g, 1e-7);
}

}  // namespace
}  // namespace softreel
