#include "render/scene/environment_radiance.h"

#include <cmath>

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(EnvironmentCoordinates, PutTheCentreAtMinusZAndRightAtPlusX) {
  EXPECT_TRUE(environment_coordinates(Vec3f(0, 0, -1), 0).isApprox(Vec2f(0.5f, 0.5f), 1e-6f));
  EXPECT_TRUE(environment_coordinates(Vec3f(1, 0, 0), 0).isApprox(Vec2f(0.75f, 0.5f), 1e-6f));
  EXPECT_NEAR(environment_coordinates(Vec3f(0, 1, 0), 0).y(), 0, 1e-6);
  EXPECT_NEAR(environment_coordinates(Vec3f(0, -1, 0), 0).y(), 1, 1e-6);
}

TEST(EnvironmentCoordinates, AreInvertedByDirection) {
  for (const float rotation : {0.0f, 1.0f, -2.5f})
    for (const Vec2f& at : {Vec2f(0.1f, 0.3f), Vec2f(0.6f, 0.8f), Vec2f(0.99f, 0.5f)}) {
      const Vec3f direction = environment_direction(at, rotation);
      EXPECT_NEAR(direction.norm(), 1, 1e-6);
      EXPECT_LT((environment_coordinates(direction, rotation) - at).norm(), 1e-5f);
    }
}

TEST(EnvironmentRadiance, GoesFromNadirOverHorizonToZenith) {
  Environment environment;
  environment.zenith = Vec3f(1, 0, 0);
  environment.horizon = Vec3f(0, 1, 0);
  environment.nadir = Vec3f(0, 0, 1);
  environment.strength = 2;
  EXPECT_EQ(environment_radiance(environment, Vec3f(0, 1, 0)), Vec3f(2, 0, 0));
  EXPECT_EQ(environment_radiance(environment, Vec3f(1, 0, 0)), Vec3f(0, 2, 0));
  EXPECT_EQ(environment_radiance(environment, Vec3f(0, -1, 0)), Vec3f(0, 0, 2));
}

TEST(EnvironmentRadiance, InterpolatesTheImageAndWrapsAround) {
  auto image = std::make_shared<EnvironmentImage>();
  image->width = 4;
  image->height = 1;
  for (const float value : {1.0f, 2.0f, 3.0f, 4.0f}) image->pixels.push_back(Vec3f::Constant(value));
  Environment environment;
  environment.image = image;
  const auto at = [&](float u) {
    return environment_radiance(environment, environment_direction(Vec2f(u, 0.5f), 0)).x();
  };
  EXPECT_NEAR(at(0.125f), 1, 1e-5);
  EXPECT_NEAR(at(0.25f), 1.5, 1e-5);
  EXPECT_NEAR(at(1e-6f), 2.5, 1e-4) << "halfway between the last and the first texel";
  EXPECT_NEAR(at(1 - 1e-6f), 2.5, 1e-4);
}

}  // namespace
}  // namespace softreel
