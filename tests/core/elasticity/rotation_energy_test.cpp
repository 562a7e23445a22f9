#include "core/elasticity/rotation_energy.h"

#include <random>

#include <gtest/gtest.h>

#include "core/elasticity/element_rotation.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {
namespace {

/// A tetrahedron of positive volume and a deformation of it, random but for the seed.
struct Sample {
  TetNodes rest, deformed;
};

Sample sample(unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Sample s{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.2, 1, 0), Vec3(0.1, 0.3, 0.8)}, {}};
  for (Vec3& node : s.rest) node += 0.1 * Vec3(normal(random), normal(random), normal(random));
  for (Vec3& node : s.deformed) node = Vec3(normal(random), normal(random), normal(random));
  return s;
}

Vec4 sample_quaternion(unsigned seed) {
  std::mt19937_64 random(seed + 1000);
  std::normal_distribution<double> normal;
  return Vec4(normal(random), normal(random), normal(random), normal(random));
}

/// q v q* for a quaternion of any length.
Vec3 conjugated(const Vec4& q, const Vec3& v) {
  const Quaternion p(q[0], q[1], q[2], q[3]);
  return (p * Quaternion(0, v.x(), v.y(), v.z()) * p.conjugate()).vec();
}

TEST(RotationEnergy, IsTheIntegralOfEq3WithTheConstraintOfEq4) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const auto [rest, deformed] = sample(seed);
    const Vec4 q = sample_quaternion(seed);
    const Vec3 c0 = 0.25 * (rest[0] + rest[1] + rest[2] + rest[3]);
    const Vec3 c = 0.25 * (deformed[0] + deformed[1] + deformed[2] + deformed[3]);
    // Four-point rule, exact for quadratics (Hammer and Stroud 1956).
    const double a = (5 + 3 * std::sqrt(5.0)) / 20, b = (5 - std::sqrt(5.0)) / 20;
    double integral = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      Vec3 x = -c, X = -c0;
      for (std::size_t i = 0; i < 4; ++i) {
        x += (i == k ? a : b) * deformed[i];
        X += (i == k ? a : b) * rest[i];
      }
      integral += tet_volume(rest[0], rest[1], rest[2], rest[3]) / 4 * (conjugated(q, x) - X).squaredNorm();
    }
    const double expected = integral + 0.7 * (q.squaredNorm() - 1);
    EXPECT_NEAR(RotationEnergy(rest, deformed).value(q, 0.7), expected, 1e-12 * (1 + expected));
  }
}

TEST(RotationEnergy, HasTheGradientOfEqs5And6) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const auto [rest, deformed] = sample(seed);
    const RotationEnergy energy(rest, deformed);
    const Vec4 q = sample_quaternion(seed);
    const double l = 0.3, step = 1e-5;
    const auto gradient = energy.gradient(q, l);
    for (int k = 0; k < 4; ++k) {
      const Vec4 d = step * Vec4::Unit(k);
      EXPECT_NEAR(gradient[k], (energy.value(q + d, l) - energy.value(q - d, l)) / (2 * step), 1e-7 * gradient.norm());
    }
    EXPECT_NEAR(gradient[4], (energy.value(q, l + step) - energy.value(q, l - step)) / (2 * step),
                1e-7 * gradient.norm());
  }
}

TEST(RotationEnergy, HasTheHessianOfEqs7And8) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const auto [rest, deformed] = sample(seed);
    const RotationEnergy energy(rest, deformed);
    const Vec4 q = sample_quaternion(seed);
    const double l = 0.3, step = 1e-5;
    const auto hessian = energy.hessian(q, l);
    for (int k = 0; k < 5; ++k) {
      const Vec4 d = k < 4 ? Vec4(step * Vec4::Unit(k)) : Vec4(Vec4::Zero());
      const double dl = k < 4 ? 0 : step;
      const auto difference = ((energy.gradient(q + d, l + dl) - energy.gradient(q - d, l - dl)) / (2 * step)).eval();
      EXPECT_LT((hessian.col(k) - difference).norm(), 1e-7 * hessian.norm());
    }
  }
}

TEST(RotationEnergy, IsStationaryAndLeastAtTheRotationFound) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto [rest, deformed] = sample(seed);
    const RotationEnergy energy(rest, deformed);
    const Quaternion back = find_element_rotation(rest, deformed, Quaternion::Identity()).conjugate();
    const Vec4 q(back.w(), back.x(), back.y(), back.z());
    EXPECT_LT(energy.gradient(q, energy.multiplier(q)).norm(), 1e-13);
    for (unsigned other = 0; other < 100; ++other)
      EXPECT_GE(energy.value(sample_quaternion(other).normalized(), 0), energy.value(q, 0) - 1e-13);
  }
}

}  // namespace
}  // namespace softreel
