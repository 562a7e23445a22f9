#include "render/pathtrace/lights/environment_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "render/pathtrace/rays/sampler.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {
namespace {

/// Dim, with one bright texel and one black row.
Environment sky() {
  auto image = std::make_shared<EnvironmentImage>();
  image->width = 16;
  image->height = 8;
  image->pixels.assign(128, Vec3f(0.1f, 0.1f, 0.1f));
  image->pixels[3 * 16 + 11] = Vec3f(50, 40, 30);
  for (std::size_t c = 0; c < 16; ++c) image->pixels[6 * 16 + c] = Vec3f::Zero();
  Environment environment;
  environment.image = image;
  environment.rotation = 0.7f;
  return environment;
}

template <typename F>
double over_sphere(const F& f) {
  constexpr int kRows = 800, kColumns = 800;
  double sum = 0;
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kColumns; ++c) {
      const double y = -1 + 2 * (r + 0.5) / kRows, azimuth = 2 * M_PI * (c + 0.5) / kColumns,
                   ring = std::sqrt(1 - y * y);
      sum += static_cast<double>(f(Vec3f(static_cast<float>(ring * std::sin(azimuth)), static_cast<float>(y),
                                         static_cast<float>(ring * std::cos(azimuth)))));
    }
  return sum * 4 * M_PI / (kRows * kColumns);
}

TEST(EnvironmentLight, DensityIntegratesToOne) {
  const Environment environment = sky();
  const EnvironmentLight light(environment);
  ASSERT_TRUE(light.sampled());
  EXPECT_NEAR(over_sphere([&](const Vec3f& d) { return light.pdf(d); }), 1, 5e-3);
}

TEST(EnvironmentLight, SamplesHaveTheDensityTheyClaim) {
  const Environment environment = sky();
  const EnvironmentLight light(environment);
  const Sampler sampler(1, 1, 1);
  for (std::uint32_t s = 0; s < 500; ++s) {
    const SampleBlock u = sampler.numbers(s, 0);
    const LightSample sample = light.sample(Vec2f(u[0], u[1]));
    EXPECT_NEAR(sample.direction.norm(), 1, 1e-5);
    EXPECT_GT(sample.pdf, 0);
    // A direction within rounding of a texel's edge may fall on its other side.
    if (std::abs(light.pdf(sample.direction) / sample.pdf - 1) > 1e-2f) {
      const Vec3f nudged = (sample.direction + Vec3f(1e-5f, 1e-5f, 1e-5f)).normalized();
      const Vec3f other = (sample.direction - Vec3f(1e-5f, 1e-5f, 1e-5f)).normalized();
      EXPECT_TRUE(std::abs(light.pdf(nudged) / sample.pdf - 1) < 1e-2f ||
                  std::abs(light.pdf(other) / sample.pdf - 1) < 1e-2f);
    }
  }
}

TEST(EnvironmentLight, SamplingAgreesWithIntegration) {
  const Environment environment = sky();
  const EnvironmentLight light(environment);
  const Sampler sampler(2, 1, 1);
  double mean = 0, squares = 0;
  constexpr int kSamples = 4096;
  for (std::uint32_t s = 0; s < kSamples; ++s) {
    const SampleBlock u = sampler.numbers(s, 0);
    const LightSample sample = light.sample(Vec2f(u[0], u[1]));
    const double value = static_cast<double>(sample.radiance.x() / sample.pdf);
    mean += value / kSamples;
    squares += value * value / kSamples;
  }
  const double integral = over_sphere([&](const Vec3f& d) { return light.radiance(d).x(); });
  EXPECT_NEAR(mean, integral, 0.01 * integral);
  EXPECT_LT(std::sqrt(squares - mean * mean), mean) << "brightness is what is sampled";
}

TEST(EnvironmentLight, GradientsAreLeftToScatteredRays) {
  const Environment gradient;
  EXPECT_FALSE(EnvironmentLight(gradient).sampled());
}

}  // namespace
}  // namespace softreel
