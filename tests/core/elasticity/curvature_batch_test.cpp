// Curvatures in lanes against the scalar function.
#include "core/elasticity/curvature_batch.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace softreel {
namespace {

struct Element {
  ElasticLaw law;
  Mat3 rotation, strain;
  double factor;
};

/// Random ones, and among them those with equal or nearly cancelling principal stretches, and none at all.
std::vector<Element> elements() {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::vector<Element> result;
  for (int k = 0; k < 203; ++k) {
    const Mat3 Q =
        Quaternion(normal(random), normal(random), normal(random), normal(random)).normalized().toRotationMatrix();
    Mat3 axes = Quaternion(normal(random), normal(random), normal(random), normal(random)).normalized().matrix();
    Vec3 strains(normal(random), normal(random), normal(random));
    if (k % 7 == 1) strains.y() = strains.x();
    if (k % 7 == 2) strains.setConstant(0.3);
    if (k % 7 == 3) strains.setZero();
    if (k % 7 == 4) strains = Vec3(-1.001, -0.999, 0.5);
    if (k % 7 == 5) axes.setIdentity();
    const Mat3 E = axes * strains.asDiagonal() * axes.transpose();
    result.push_back({{2e4 * (1 + k % 3), 1e4, k % 2 == 0}, Q, 0.5 * (E + E.transpose()), normal(random)});
  }
  return result;
}

TEST(CurvatureBatch, AddsWhatTheScalarFunctionSays) {
  const std::vector<Element> all = elements();
  for (const bool positive_part : {false, true}) {
    std::vector<Mat3> sums(all.size(), Mat3::Identity());
    CurvatureBatch batch(positive_part);
    for (std::size_t e = 0; e < all.size(); ++e)
      batch.add(all[e].law, all[e].rotation, all[e].strain, all[e].factor, sums[e]);
    batch.finish();
    for (std::size_t e = 0; e < all.size(); ++e) {
      const Mat3 F = all[e].rotation * (Mat3::Identity() + all[e].strain);
      const Mat3 expected =
          Mat3::Identity() + all[e].factor * rotation_curvature(all[e].law, all[e].rotation, F, positive_part);
      EXPECT_LT((sums[e] - expected).norm(), 1e-9 * expected.norm()) << e;
    }
  }
}

}  // namespace
}  // namespace softreel
