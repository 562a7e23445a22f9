#include "render/pathtrace/lights/rectangle_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "render/pathtrace/rays/sampler.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {
namespace {

/// 2 m x 1 m at height 1, shining down.
AreaLight lamp() {
  AreaLight light;
  light.center = Vec3f(0, 1, 0);
  light.u = Vec3f(0, 0, 0.5f);
  light.v = Vec3f(-1, 0, 0);
  if (light.u.cross(light.v).y() > 0) light.v = -light.v;
  light.radiance = Vec3f(2, 2, 2);
  return light;
}

/// Solid angle of a rectangle a x b seen from distance d over one corner: asin of the sines of its half angles.
double corner_solid_angle(double a, double b, double d) {
  return std::atan(a * b / (d * std::sqrt(a * a + b * b + d * d)));
}

TEST(RectangleLight, NearbyDensityIsOneOverTheSolidAngle) {
  const RectangleLight light(lamp());
  LightSample sample;
  ASSERT_TRUE(light.sample(Vec3f(0, 0, 0), Vec2f(0.3f, 0.6f), sample));
  EXPECT_NEAR(1 / sample.pdf, 4 * corner_solid_angle(1, 0.5, 1), 1e-4);
  ASSERT_TRUE(light.sample(Vec3f(1, 0.5f, 0.5f), Vec2f(0.3f, 0.6f), sample));
  EXPECT_NEAR(1 / sample.pdf, corner_solid_angle(2, 1, 0.5), 1e-4);
}

TEST(RectangleLight, SamplesLieOnTheLightWithTheirDensity) {
  const RectangleLight light(lamp());
  const Sampler sampler(1, 1, 1);
  for (const Vec3f& p : {Vec3f(0, 0, 0), Vec3f(0.9f, 0.95f, 0.2f), Vec3f(3, 0, 1), Vec3f(30, -20, 10)})
    for (std::uint32_t s = 0; s < 200; ++s) {
      const SampleBlock u = sampler.numbers(s, 0);
      LightSample sample;
      ASSERT_TRUE(light.sample(p, Vec2f(u[0], u[1]), sample));
      const Vec3f at = p + sample.distance * sample.direction;
      EXPECT_NEAR(at.y(), 1, 1e-4);
      EXPECT_LE(std::abs(at.x()), 1.001f);
      EXPECT_LE(std::abs(at.z()), 0.501f);
      EXPECT_NEAR(light.pdf(p, sample.direction, sample.distance), sample.pdf, 1e-3f * sample.pdf);
    }
}

TEST(RectangleLight, MeanOfCosineOverDensityIsTheFormFactor) {
  // Irradiance under the centre of a lamp: pi L times the configuration factor, 4 times that of a corner.
  const auto corner = [](double a, double b) {
    const double x = std::sqrt(1 + a * a), y = std::sqrt(1 + b * b);
    return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2 * M_PI);
  };
  const RectangleLight light(lamp());
  const Sampler sampler(1, 2, 3);
  double sum = 0;
  for (std::uint32_t s = 0; s < 1024; ++s) {
    const SampleBlock u = sampler.numbers(s, 0);
    LightSample sample;
    ASSERT_TRUE(light.sample(Vec3f(0, 0, 0), Vec2f(u[0], u[1]), sample));
    sum += static_cast<double>(sample.direction.y() / sample.pdf);
  }
  EXPECT_NEAR(sum / 1024, M_PI * 4 * corner(1, 0.5), 1e-3);
}

TEST(RectangleLight, FarAndNearSamplingMeetSmoothly) {
  // Means of 1 / pdf are the solid angle on both sides of the switch.
  const RectangleLight light(lamp());
  const auto solid_angle = [&](float height) {
    const Sampler sampler(5, 2, 3);
    double sum = 0;
    for (std::uint32_t s = 0; s < 1024; ++s) {
      const SampleBlock u = sampler.numbers(s, 0);
      LightSample sample;
      EXPECT_TRUE(light.sample(Vec3f(0, 1 - height, 0), Vec2f(u[0], u[1]), sample));
      sum += 1 / static_cast<double>(sample.pdf);
    }
    return sum / 1024;
  };
  for (const float height : {4.4f, 4.5f})
    EXPECT_NEAR(solid_angle(height), 4 * corner_solid_angle(1, 0.5, height), 1e-4);
}

TEST(RectangleLight, ShinesToOneSideOnly) {
  const RectangleLight light(lamp());
  LightSample sample;
  float distance = 0;
  EXPECT_FALSE(light.sample(Vec3f(0, 2, 0), Vec2f(0.5f, 0.5f), sample));
  EXPECT_EQ(light.importance(Vec3f(0, 2, 0)), 0);
  EXPECT_FALSE(light.intersect(Vec3f(0, 2, 0), Vec3f(0, -1, 0), 10, distance));
  EXPECT_TRUE(light.intersect(Vec3f(0.9f, 0, 0.4f), Vec3f(0, 1, 0), 10, distance));
  EXPECT_FLOAT_EQ(distance, 1);
  EXPECT_FALSE(light.intersect(Vec3f(0.9f, 0, 0.6f), Vec3f(0, 1, 0), 10, distance));
  EXPECT_FALSE(light.intersect(Vec3f(0, 0, 0), Vec3f(0, 1, 0), 0.9f, distance)) << "behind the hit";
}

TEST(RectangleLight, RefusesEdgesThatSpanNoRectangle) {
  AreaLight light = lamp();
  light.u = light.v + Vec3f(0, 0, 0.1f);
  EXPECT_THROW(RectangleLight{light}, Error);
  light.u = Vec3f::Zero();
  EXPECT_THROW(RectangleLight{light}, Error);
}

}  // namespace
}  // namespace softreel
