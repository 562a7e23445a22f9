// Every kind of light gives a small patch the irradiance that its geometry says, by sampling and by brute force.
#include <functional>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "render/pathtrace/lights/light_set.h"
#include "render/pathtrace/rays/sampler.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

struct LampCase {
  const char* name;
  AreaLight lamp;
  double irradiance;  ///< at the origin on a patch that faces up, for radiance 1
};

AreaLight lamp_above(LampShape shape, const Vec3f& center, float a, float b) {
  AreaLight lamp;
  lamp.shape = shape;
  lamp.center = center;
  lamp.u = Vec3f(a, 0, 0);
  lamp.v = Vec3f(0, 0, b);  // u x v points down
  return lamp;
}

/// Irradiance from a rectangle of half edges a, b at height h over its middle: four corner rectangles.
double rectangle_irradiance(double a, double b, double h) {
  const double x = std::sqrt(a * a + h * h), y = std::sqrt(b * b + h * h);
  return 2 * (a / x * std::atan(b / x) + b / y * std::atan(a / y));
}

std::vector<LampCase> cases() {
  const double d2 = 0.9 * 0.9 + 1.2 * 1.2;
  return {
      {"disk", lamp_above(LampShape::Disk, Vec3f(0, 1, 0), 0.5f, 0.5f), M_PI * 0.25 / (0.25 + 1)},
      {"wide disk, near", lamp_above(LampShape::Disk, Vec3f(0, 0.2f, 0), 1, 1), M_PI / (1 + 0.04)},
      {"sphere overhead", lamp_above(LampShape::Sphere, Vec3f(0, 2, 0), 0.5f, 0), M_PI * 0.0625},
      {"sphere aside", lamp_above(LampShape::Sphere, Vec3f(0.9f, 1.2f, 0), 0.6f, 0),
       M_PI * 0.36 / d2 * 1.2 / std::sqrt(d2)},
      {"rectangle", lamp_above(LampShape::Rectangle, Vec3f(0, 1, 0), 0.5f, 1), rectangle_irradiance(0.5, 1, 1)},
  };
}

/// Mean of `value(numbers)` over well-spread numbers.
double mean_over(std::uint32_t samples, const std::function<double(const SampleBlock&)>& value) {
  const Sampler sampler(7, 1, 2);
  double sum = 0;
  for (std::uint32_t s = 0; s < samples; ++s) sum += value(sampler.numbers(s, 0));
  return sum / samples;
}

const Receiver kPatch{Vec3f::Zero(), Vec3f(0, 1, 0), false};

/// By sampling lights, without weights.
double sampled_irradiance(const LightSet& lights, std::uint32_t samples) {
  return mean_over(samples, [&](const SampleBlock& u) {
    LightSample light;
    bool point_like = false;
    if (!lights.sample(kPatch, u[4], Vec2f(u[0], u[1]), light, point_like)) return 0.0;
    return static_cast<double>(light.radiance.x() * std::max(0.0f, light.direction.y()) / light.pdf);
  });
}

/// By rays in all directions; with `pdf_scale` weighed against light sampling and completed by it.
double scattered_irradiance(const LightSet& lights, bool weighed, std::uint32_t samples) {
  return mean_over(samples, [&](const SampleBlock& u) {
    const Vec3f local = cosine_hemisphere(Vec2f(u[2], u[3]));
    const Vec3f direction(local.x(), local.z(), -local.y());
    RayOrigin origin;
    if (weighed) origin = {kPatch, local.z() / kPi, false, false};
    double value = M_PI * static_cast<double>(lights.area_lights_along(Vec3f::Zero(), direction, 1e9f, origin).x());
    LightSample light;
    bool point_like = false;
    if (weighed && lights.sample(kPatch, u[4], Vec2f(u[0], u[1]), light, point_like)) {
      const float cosine = std::max(0.0f, light.direction.y());
      value += static_cast<double>(light.radiance.x() * cosine / light.pdf * power_heuristic(light.pdf, cosine / kPi));
    }
    return value;
  });
}

TEST(Lamp, GivesTheIrradianceOfItsGeometry) {
  for (const LampCase& c : cases()) {
    Scene scene = scene_in_sky(0);
    scene.area_lights = {c.lamp};
    const LightSet lights(scene);
    EXPECT_NEAR(sampled_irradiance(lights, 1 << 12), c.irradiance, 5e-3 * c.irradiance) << c.name;
    EXPECT_NEAR(scattered_irradiance(lights, false, 1 << 15), c.irradiance, 1e-2 * c.irradiance) << c.name;
    EXPECT_NEAR(scattered_irradiance(lights, true, 1 << 12), c.irradiance, 1e-2 * c.irradiance) << c.name;
  }
}

TEST(Lamp, SampledDirectionsMeetItWhereTheSampleSays) {
  for (const LampCase& c : cases()) {
    Scene scene = scene_in_sky(0);
    scene.area_lights = {c.lamp};
    const LightSet lights(scene);
    const Sampler sampler(3, 3, 3);
    for (std::uint32_t s = 0; s < 200; ++s) {
      const SampleBlock u = sampler.numbers(s, 0);
      LightSample light;
      bool point_like = false;
      // Just inside the rim, where rounding decides.
      const Vec2f inner(0.01f + 0.98f * u[0], 0.01f + 0.98f * u[1]);
      ASSERT_TRUE(lights.sample(kPatch, 0, inner, light, point_like)) << c.name;
      EXPECT_EQ(lights.area_lights_along(Vec3f::Zero(), light.direction, light.distance * 1.001f + 1e-5f, {}).x(), 1)
          << c.name;
      EXPECT_EQ(lights.area_lights_along(Vec3f::Zero(), light.direction, light.distance * 0.999f - 1e-5f, {}).x(), 0)
          << c.name;
    }
  }
}

TEST(Lamp, SpheresShineOutwardsOnly) {
  Scene scene = scene_in_sky(0);
  scene.area_lights = {lamp_above(LampShape::Sphere, Vec3f(0, 0.1f, 0), 1, 0)};
  const LightSet lights(scene);
  EXPECT_EQ(sampled_irradiance(lights, 16), 0);
  EXPECT_EQ(scattered_irradiance(lights, false, 256), 0);
}

TEST(Lamp, RefusesWhatHasNoExtent) {
  Scene scene;
  scene.area_lights = {lamp_above(LampShape::Sphere, Vec3f(0, 1, 0), 0, 0)};
  EXPECT_THROW(LightSet{scene}, Error);
  scene.area_lights = {lamp_above(LampShape::Disk, Vec3f(0, 1, 0), 1, 0)};
  EXPECT_THROW(LightSet{scene}, Error);
}

/// A shelf of small lamps, all of them turned in their own way.
std::vector<AreaLight> many_lamps(int count) {
  std::vector<AreaLight> lamps;
  const Sampler sampler(11, 0, 0);
  for (int k = 0; k < count; ++k) {
    const SampleBlock u = sampler.numbers(static_cast<std::uint32_t>(k), 0);
    AreaLight lamp;
    lamp.shape = static_cast<LampShape>(k % 3);
    lamp.center = Vec3f(6 * u[0] - 3, 0.4f + 2 * u[1], 6 * u[2] - 3);
    const Vec3f tilt = Vec3f(u[3] - 0.5f, 1, u[4] - 0.5f).normalized();
    lamp.u = 0.1f * tilt.cross(Vec3f(1, 0, 0)).normalized();
    lamp.v = tilt.cross(lamp.u);
    if (k % 2 == 0) lamp.v = -lamp.v;
    lamp.radiance = Vec3f::Constant(0.5f + 4 * u[5]);
    lamps.push_back(lamp);
  }
  return lamps;
}

TEST(ManyLamps, ChosenByATreeGiveTheSumOfEachAlone) {
  const std::vector<AreaLight> lamps = many_lamps(200);
  double expected = 0;
  for (const AreaLight& lamp : lamps) {
    Scene one = scene_in_sky(0);
    one.area_lights = {lamp};
    expected += sampled_irradiance(LightSet(one), 1 << 9);
  }
  Scene scene = scene_in_sky(0);
  scene.area_lights = lamps;
  const LightSet lights(scene);
  EXPECT_EQ(lights.count(), 1u);
  EXPECT_NEAR(sampled_irradiance(lights, 1 << 16), expected, 0.01 * expected);
  EXPECT_NEAR(scattered_irradiance(lights, false, 1 << 16), expected, 0.03 * expected);
  EXPECT_NEAR(scattered_irradiance(lights, true, 1 << 15), expected, 0.01 * expected);
}

TEST(LightTree, ProbabilitiesAreThoseOfItsChoicesAndAddUpToOne) {
  std::vector<EmitterBounds> emitters;
  for (const AreaLight& lamp : many_lamps(64)) {
    const Vec3f half = lamp.u.cwiseAbs() + lamp.v.cwiseAbs();
    emitters.push_back(
        {lamp.center - half, lamp.center + half, {lamp.u.cross(lamp.v).normalized(), 0.2f}, lamp.radiance.x()});
  }
  const LightTree tree(emitters);
  const TreeReceiver receiver{Vec3f(0.3f, 0.1f, 0), Vec3f(0, 1, 0), false};
  std::vector<double> found(emitters.size());
  const int samples = 1 << 16;
  int chosen = 0;
  for (int s = 0; s < samples; ++s) {
    float u = (static_cast<float>(s) + 0.5f) / samples, probability = 0;
    Index emitter = -1;
    if (!tree.choose(receiver, u, emitter, probability)) continue;
    EXPECT_GE(u, 0);
    EXPECT_LT(u, 1);
    EXPECT_NEAR(probability / tree.probability(receiver, emitter), 1, 1e-4);
    found[static_cast<std::size_t>(emitter)] += 1;
    ++chosen;
  }
  double sum = 0;
  for (std::size_t k = 0; k < emitters.size(); ++k) {
    const double p = static_cast<double>(tree.probability(receiver, static_cast<Index>(k)));
    EXPECT_NEAR(found[k] / samples, p, 1e-3);
    sum += p;
  }
  EXPECT_NEAR(sum, static_cast<double>(chosen) / samples, 2e-3);
  EXPECT_GT(sum, 0.8) << "few dead ends";
}

/// A float's acos of a direction's product with itself is not 0.
TEST(DirectionCone, OfEqualDirectionsStaysNarrow) {
  const Sampler sampler(5, 5, 6);
  for (std::uint32_t s = 0; s < 1000; ++s) {
    const SampleBlock u = sampler.numbers(s, 0);
    const Vec3f n = uniform_cone(Vec2f(u[0], u[1]), 2);
    const DirectionCone both = DirectionCone{n, 0}.joined({(n + Vec3f::Constant(1e-7f)).normalized(), 0});
    EXPECT_LT(both.angle, 0.01f) << s;
    EXPECT_GT(both.axis.dot(n), 0.999f);
  }
  EXPECT_GT((DirectionCone{Vec3f::UnitX(), 0}.joined({-Vec3f::UnitX(), 0}).angle), 1.5f);
}

TEST(DirectionCone, HoldsBothOfTheConesThatItJoins) {
  const Sampler sampler(5, 5, 5);
  for (std::uint32_t s = 0; s < 500; ++s) {
    const SampleBlock u = sampler.numbers(s, 0);
    const DirectionCone a{uniform_cone(Vec2f(u[0], u[1]), 2), 1.5f * u[4]},
        b{uniform_cone(Vec2f(u[2], u[3]), 2), 1.5f * u[5]};
    const DirectionCone both = a.joined(b);
    for (const DirectionCone& part : {a, b}) {
      const float between = std::acos(std::clamp(both.axis.dot(part.axis), -1.0f, 1.0f));
      EXPECT_TRUE(both.angle >= kPi - 1e-3f || between + part.angle <= both.angle + 1e-3f) << s;
    }
  }
}

}  // namespace
}  // namespace softreel
