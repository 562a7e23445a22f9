#include "render/preview/sky_harmonics.h"

#include <cmath>

#include <gtest/gtest.h>

#include "render/scene/environment_radiance.h"

namespace softreel {
namespace {

template <typename Radiance>
EnvironmentImage image_of(int width, const Radiance& radiance) {
  EnvironmentImage image{width, width / 2, {}};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec2f at((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                     (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height));
      image.pixels.push_back(Vec3f::Constant(radiance(environment_direction(at, 0))));
    }
  return image;
}

const Vec3f kNormals[] = {Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, -1), Vec3f(0.48f, -0.6f, 0.64f)};

TEST(SkyHarmonics, AnEvenSkyLightsEverySideAlike) {
  const SkyHarmonics harmonics = sky_harmonics(image_of(64, [](const Vec3f&) { return 0.7f; }));
  for (const Vec3f& n : kNormals) EXPECT_NEAR(sky_light(harmonics, n).x(), 0.7f, 2e-3f) << n.transpose();
}

TEST(SkyHarmonics, KeepTwoThirdsOfWhatGrowsAlongADirection) {
  const Vec3f along(0.3f, -0.5f, 0.4f);
  const SkyHarmonics harmonics = sky_harmonics(image_of(128, [&](const Vec3f& d) { return 1 + along.dot(d); }));
  for (const Vec3f& n : kNormals)
    EXPECT_NEAR(sky_light(harmonics, n).x(), 1 + along.dot(n) * 2 / 3, 2e-3f) << n.transpose();
}

TEST(SkyHarmonics, KeepAQuarterOfSaddles) {
  const auto saddle = [](const Vec3f& d) {
    return 0.4f * d.x() * d.y() - 0.3f * d.y() * d.z() + 0.2f * d.x() * d.z() + 0.1f * (3 * d.y() * d.y() - 1) +
           0.5f * (d.x() * d.x() - d.z() * d.z());
  };
  const SkyHarmonics harmonics = sky_harmonics(image_of(128, [&](const Vec3f& d) { return 2 + saddle(d); }));
  for (const Vec3f& n : kNormals) EXPECT_NEAR(sky_light(harmonics, n).x(), 2 + saddle(n) / 4, 2e-3f) << n.transpose();
}

TEST(SkyHarmonics, ASmallSunIsBrightestAcrossAndAboutAsBrightAsItIs) {
  // A cap of 10 degrees around `sun`, so bright that it gives irradiance pi: sky_light is 1 on what faces it.
  const Vec3f sun(0.6f, 0.8f, 0);
  const float share = std::sin(0.1745f);
  const SkyHarmonics harmonics = sky_harmonics(
      image_of(512, [&](const Vec3f& d) { return d.dot(sun) > std::cos(0.1745f) ? 1 / (share * share) : 0; }));
  EXPECT_NEAR(sky_light(harmonics, sun).x(), 1, 0.1f);
  EXPECT_NEAR(sky_light(harmonics, Vec3f(0, 0, 1)).x(), 0, 0.1f);
  EXPECT_NEAR(sky_light(harmonics, -sun).x(), 0, 0.1f);
}

}  // namespace
}  // namespace softreel
