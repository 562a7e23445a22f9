#include "core/elasticity/element_strain.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/elasticity/element.h"
#include "core/elasticity/element_rotation.h"

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

TEST(GreenStrain, IsHalfOfWhatSquaredLengthsGainAndKnowsNoRotation) {
  std::mt19937 random(6);
  Mat3 F;
  F << 1.1, 0.3, 0, -0.2, 0.8, 0.1, 0.05, 0, 1.4;
  const Vec3 edge(0.3, -1, 0.7);
  const double gain = (F * edge).squaredNorm() - edge.squaredNorm();
  EXPECT_NEAR(edge.dot(green_strain(F) * edge), 0.5 * gain, 1e-14);
  EXPECT_TRUE(green_strain(random_rotation(random) * F).isApprox(green_strain(F), 1e-13));
}

TEST(CauchyStress, OfAFreeBarUnderTensionIsForceOverDeformedAreaAlongItsAxis) {
  // E times strain is the force over the area at rest; the thickness shrinks by nu times strain.
  const ElementMaterial m = material(3e5, 0.3);
  const double strain = 0.1, thin = 1 - 0.3 * strain;
  std::mt19937 random(7);
  for (int k = 0; k < 20; ++k) {
    const Mat3 turn = random_rotation(random);
    const Mat3 F = turn * Vec3(1 + strain, thin, thin).asDiagonal();
    const Mat3 stress = cauchy_stress(corotated_stress({m.lame_lambda(), m.lame_mu(), true}, turn, F), F);
    const Vec3 axis = turn.col(0);
    const double along = 3e5 * strain / (thin * thin);
    EXPECT_TRUE(stress.isApprox(along * axis * axis.transpose(), 1e-12)) << k;
    EXPECT_NEAR(von_mises_of(stress), along, 1e-7);
  }
}

TEST(CauchyStress, CarriesTheForcesOfAFaceWhateverTheDeformation) {
  // Nanson: force = P N dA = sigma n da, with n da = det F F^-T N dA.
  Mat3 F;
  F << 1.2, 0.2, -0.1, 0.1, 0.7, 0.3, 0, -0.2, 1.1;
  const Mat3 turn = find_rotation(F, Quaternion::Identity()).toRotationMatrix();
  const Mat3 first_piola = corotated_stress({2e5, 1e5, true}, turn, F);
  const Mat3 stress = cauchy_stress(first_piola, F);
  const Vec3 area(0.2, -0.5, 0.4);
  const Vec3 deformed_area = F.determinant() * F.inverse().transpose() * area;
  EXPECT_TRUE((stress * deformed_area).isApprox(first_piola * area, 1e-12));
}

TEST(CauchyStress, OfAFlatElementIsNoNumber) {
  const Mat3 flat = Vec3(1, 1, 0).asDiagonal();
  EXPECT_TRUE(std::isnan(cauchy_stress(Mat3::Identity(), flat)(0, 0)));
}

TEST(VonMisesOf, KnowsNoPressureAndIsRootThreeTimesAShear) {
  Mat3 stress = 7e5 * Mat3::Identity();
  EXPECT_NEAR(von_mises_of(stress), 0, 1e-6);
  stress(0, 1) = stress(1, 0) = 1e3;
  EXPECT_NEAR(von_mises_of(stress), std::sqrt(3.0) * 1e3, 1e-6);
}

}  // namespace
}  // namespace softreel
