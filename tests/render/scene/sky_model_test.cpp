#include "render/scene/sky_model.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

double luminance_of(const Vec3f& c) {
  return 0.2126 * static_cast<double>(c.x()) + 0.7152 * static_cast<double>(c.y()) +
         0.0722 * static_cast<double>(c.z());
}

Daylight daylight(double elevation_deg, float turbidity) {
  return {static_cast<float>(elevation_deg * M_PI / 180), 0.7f, turbidity, 0};
}

/// Irradiance of the sky on the ground, by a midpoint rule in height and turn.
double sky_irradiance(const SkyModel& sky) {
  double sum = 0;
  const int rows = 200, columns = 400;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double polar = 0.5 * M_PI * (r + 0.5) / rows, turn = 2 * M_PI * (c + 0.5) / columns;
      const Vec3f d(static_cast<float>(std::sin(polar) * std::sin(turn)), static_cast<float>(std::cos(polar)),
                    static_cast<float>(std::sin(polar) * std::cos(turn)));
      sum += static_cast<double>(sky.radiance(d).y()) * std::cos(polar) * std::sin(polar);
    }
  return sum * (0.5 * M_PI / rows) * (2 * M_PI / columns);
}

TEST(SkyModel, StraightUpItHasTheLuminanceOfTheFit) {
  for (const double elevation : {10.0, 40.0, 80.0})
    for (const float turbidity : {2.0f, 3.0f, 6.0f}) {
      const SkyModel sky(daylight(elevation, turbidity));
      const double t = static_cast<double>(turbidity), angle = (90 - elevation) * M_PI / 180;
      const double expected =
          (4.0453 * t - 4.9710) * std::tan((4.0 / 9 - t / 120) * (M_PI - 2 * angle)) - 0.2155 * t + 2.4192;
      EXPECT_NEAR(10 * luminance_of(sky.radiance(Vec3f(0, 1, 0))), expected, 0.02 * expected);
    }
}

TEST(SkyModel, IsBrightestAroundTheSunAndBlueAwayFromIt) {
  const SkyModel sky(daylight(30, 2.5f));
  const double at_sun = luminance_of(sky.radiance(sky.towards_sun()));
  Vec3f away = -sky.towards_sun();
  away.y() = -away.y();
  EXPECT_GT(at_sun, 3 * luminance_of(sky.radiance(away)));
  const Vec3f zenith = sky.radiance(Vec3f(0, 1, 0));
  EXPECT_GT(zenith.z(), 1.5f * zenith.x());
}

TEST(SkyModel, BrightensWithHaze) {
  EXPECT_LT(sky_irradiance(SkyModel(daylight(45, 2))), sky_irradiance(SkyModel(daylight(45, 3))));
  EXPECT_LT(sky_irradiance(SkyModel(daylight(45, 3))), sky_irradiance(SkyModel(daylight(45, 6))));
}

TEST(SkyModel, TheSunReddensAndFadesTowardsTheHorizon) {
  double before = 1e9, hue_before = 1e9;
  for (const double elevation : {90.0, 45.0, 20.0, 8.0, 3.0}) {
    const Vec3f sun = SkyModel(daylight(elevation, 3)).sun_irradiance();
    EXPECT_LT(luminance_of(sun), before);
    before = luminance_of(sun);
    const double hue = static_cast<double>(sun.z() / sun.x());
    EXPECT_LT(hue, hue_before);
    hue_before = hue;
  }
  // 80 to 115 klx from a high sun in clear air.
  EXPECT_NEAR(luminance_of(SkyModel(daylight(70, 2.5f)).sun_irradiance()), 9.8, 1.8);
}

TEST(SkyModel, AsAnEnvironmentItLightsAPatchByItsIntegral) {
  const SkyModel sky(daylight(50, 3));
  Scene scene;
  scene.environment.image = sky_image(sky);
  scene.meshes = {square(1, 0, matte(0.5f))};
  scene.camera = camera_above(10, 0.5f);
  const double expected = 0.5 / M_PI * sky_irradiance(sky);
  EXPECT_NEAR(mean_of(rendered(scene, small_params(8, 256)).channels[1]), expected, 0.01 * expected);
}

TEST(SkyModel, GroundBelowSendsBackItsShareOfSunAndSky) {
  Daylight light = daylight(60, 3);
  light.ground_albedo = 0.4f;
  const SkyModel sky(light);
  const double irradiance = sky_irradiance(sky) + static_cast<double>(sky.sun_irradiance().y() * sky.towards_sun().y());
  EXPECT_NEAR(sky.radiance(Vec3f(0, -1, 0)).y(), 0.4 / M_PI * irradiance, 0.01 * irradiance);
}

TEST(SkyModel, RefusesWhatItWasNotFittedTo) {
  EXPECT_THROW(SkyModel(daylight(-1, 3)), Error);
  EXPECT_THROW(SkyModel(daylight(30, 1)), Error);
  EXPECT_THROW(SkyModel(daylight(30, 1.9f)), Error) << "the fit divides by what is nothing near 1.7";
  EXPECT_THROW(SkyModel(daylight(30, 12)), Error);
}

}  // namespace
}  // namespace softreel
