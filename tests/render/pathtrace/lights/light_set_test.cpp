#include "render/pathtrace/lights/light_set.h"

#include <algorithm>
#include <array>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "render/pathtrace/rays/sampler.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// Two lamps of different strength and a sun; black sky.
Scene lit_scene() {
  Scene scene = scene_in_sky(0);
  for (const float x : {-2.0f, 2.0f}) {
    AreaLight lamp;
    lamp.center = Vec3f(x, 2, 0);
    lamp.u = Vec3f(0.5f, 0, 0);
    lamp.v = Vec3f(0, 0, 0.5f);
    if (lamp.u.cross(lamp.v).y() > 0) lamp.v = -lamp.v;
    lamp.radiance = Vec3f::Constant(3 + x);
    scene.area_lights.push_back(lamp);
  }
  SunLight sun;
  sun.direction = Vec3f(-1, -1, 0).normalized();
  sun.irradiance = Vec3f::Constant(2);
  sun.angular_diameter = 0.2f;
  scene.suns = {sun};
  return scene;
}

/// Irradiance at the origin by sampling lights, and by weighing scattered rays, summed: two estimates that complement
/// each other.
double irradiance_with_weights(const LightSet& lights, const Receiver& receiver, std::uint32_t samples) {
  const Sampler sampler(1, 2, 3);
  double sum = 0;
  for (std::uint32_t s = 0; s < samples; ++s) {
    const SampleBlock u = sampler.numbers(s, 0);
    LightSample light;
    bool point_like = false;
    if (lights.sample(receiver, u[4], Vec2f(u[0], u[1]), light, point_like)) {
      const float cosine = std::max(0.0f, light.direction.y());
      sum += static_cast<double>(light.radiance.x() * cosine / light.pdf *
                                 (point_like ? 1 : power_heuristic(light.pdf, cosine / kPi)));
    }
    const Vec3f local = cosine_hemisphere(Vec2f(u[2], u[3]));
    const Vec3f direction(local.x(), local.z(), -local.y());
    RayOrigin origin{receiver, local.z() / kPi, false, false};
    const Vec3f found =
        lights.area_lights_along(receiver.position, direction, 1e9f, origin) + lights.surroundings(direction, origin);
    sum += static_cast<double>(found.x()) * M_PI;
  }
  return sum / samples;
}

/// The same by scattered rays alone.
double irradiance_by_brute_force(const LightSet& lights, std::uint32_t samples) {
  const Sampler sampler(4, 5, 6);
  double sum = 0;
  for (std::uint32_t s = 0; s < samples; ++s) {
    const SampleBlock u = sampler.numbers(s, 0);
    const Vec3f local = cosine_hemisphere(Vec2f(u[2], u[3]));
    const Vec3f direction(local.x(), local.z(), -local.y());
    const RayOrigin camera;
    sum += M_PI * static_cast<double>((lights.area_lights_along(Vec3f::Zero(), direction, 1e9f, camera) +
                                       lights.surroundings(direction, camera))
                                          .x());
  }
  return sum / samples;
}

TEST(LightSet, WeighedSamplingAgreesWithBruteForce) {
  const Scene scene = lit_scene();
  const LightSet lights(scene);
  const Receiver receiver{Vec3f::Zero(), Vec3f(0, 1, 0), false};
  const double expected = irradiance_by_brute_force(lights, 1 << 16);
  EXPECT_NEAR(irradiance_with_weights(lights, receiver, 1 << 12), expected, 0.01 * expected);
}

TEST(LightSet, SunGivesItsIrradiance) {
  for (const float diameter : {0.0f, 0.0093f, 0.5f}) {
    Scene scene = scene_in_sky(0);
    SunLight sun;
    sun.irradiance = Vec3f(3, 2, 1);
    sun.angular_diameter = diameter;
    scene.suns = {sun};
    const LightSet lights(scene);
    const Receiver receiver{Vec3f::Zero(), Vec3f(0, 1, 0), false};
    EXPECT_NEAR(irradiance_with_weights(lights, receiver, 1 << 12), 3, 0.01) << diameter;
  }
}

TEST(LightSet, LightsBelowTheHorizonAreNotChosen) {
  const Scene scene = lit_scene();
  const LightSet lights(scene);
  LightSample sample;
  bool point_like = false;
  const Receiver down{Vec3f::Zero(), Vec3f(0, -1, 0), false};
  EXPECT_FALSE(lights.sample(down, 0.5f, Vec2f(0.5f, 0.5f), sample, point_like));
  const Receiver glass{Vec3f::Zero(), Vec3f(0, -1, 0), true};
  EXPECT_TRUE(lights.sample(glass, 0.5f, Vec2f(0.5f, 0.5f), sample, point_like));
}

TEST(LightSet, HidesInvisibleLampsFromTheCameraOnly) {
  Scene scene = lit_scene();
  scene.area_lights[0].visible = false;
  const LightSet lights(scene);
  const Vec3f under(-2, 0, 0), up(0, 1, 0);
  EXPECT_EQ(lights.area_lights_along(under, up, 1e9f, RayOrigin{}), Vec3f(0, 0, 0));
  RayOrigin mirror;
  mirror.from_camera = false;
  EXPECT_EQ(lights.area_lights_along(under, up, 1e9f, mirror), Vec3f(1, 1, 1));
}

/// Lamps of all shapes about the origin, and apart from them a row of spheres along x.
std::vector<AreaLight> many_lamps() {
  std::mt19937 random(7);
  const auto number = [&](float least, float most) { return std::uniform_real_distribution(least, most)(random); };
  std::vector<AreaLight> lamps;
  for (int k = 0; k < 300; ++k) {
    AreaLight lamp;
    lamp.shape = std::array{LampShape::Rectangle, LampShape::Disk, LampShape::Sphere}[static_cast<std::size_t>(k % 3)];
    lamp.center =
        k < 200 ? Vec3f(number(-4, 4), number(-4, 4), number(-4, 4)) : Vec3f(0.2f * static_cast<float>(k), 20, 0);
    if (k >= 200) lamp.shape = LampShape::Sphere;
    const float size = k < 200 ? number(0.01f, 1) : 0.05f;
    lamp.u = size * Vec3f(number(-1, 1), number(-1, 1), number(-1, 1)).normalized();
    lamp.v = number(0.1f, 1) * lamp.u.cross(Vec3f(number(-1, 1), number(-1, 1), number(-1, 1)));
    lamp.radiance = Vec3f(number(0, 1), number(0, 1), number(0, 1));
    lamps.push_back(lamp);
  }
  return lamps;
}

TEST(LightSet, RaysMeetTheSameOfManyLampsAsOfEachAlone) {
  Scene scene = scene_in_sky(0);
  scene.area_lights = many_lamps();
  const LightSet all(scene);
  std::vector<LightSet> single;
  for (const AreaLight& lamp : many_lamps()) {
    scene.area_lights = {lamp};
    single.emplace_back(scene);
  }
  std::mt19937 random(8);
  const auto number = [&](float least, float most) { return std::uniform_real_distribution(least, most)(random); };
  int lit = 0;
  for (int k = 0; k < 3000; ++k) {
    // Every tenth one along the row: more lamps than the tree names.
    const bool on_row = k % 10 == 0;
    const Vec3f origin = on_row ? Vec3f(20, 20, 0) : Vec3f(number(-4, 4), number(-4, 4), number(-4, 4));
    const Vec3f direction =
        on_row ? Vec3f(1, 0, 0) : Vec3f(Vec3f(number(-1, 1), number(-1, 1), number(-1, 1)).normalized());
    const float length = k % 3 == 0 ? number(0, 10) : std::numeric_limits<float>::infinity();
    Vec3f expected = Vec3f::Zero();
    for (const LightSet& one : single) expected += one.area_lights_along(origin, direction, length, RayOrigin{});
    ASSERT_EQ(all.area_lights_along(origin, direction, length, RayOrigin{}), expected) << k;
    if (!expected.isZero(0)) ++lit;
  }
  EXPECT_GT(lit, 500);
}

TEST(LightTree, ARayAsksFewOfManyEmitters) {
  std::vector<EmitterBounds> emitters;
  for (int k = 0; k < 4096; ++k) {
    const auto at = [&](int divisor) { return static_cast<float>(k / divisor % 16); };
    const Vec3f low(at(1), at(16), at(256));
    emitters.push_back({low, low + Vec3f::Constant(0.1f), {Vec3f(0, 1, 0), 0}, 1});
  }
  const LightTree tree(emitters);
  std::vector<Index> visited;
  tree.visit_along(Vec3f(-1, 3.05f, 7.05f), Vec3f(1, 0, 0), 10, [&](Index emitter) { visited.push_back(emitter); });
  std::sort(visited.begin(), visited.end());
  std::vector<Index> row;
  for (Index k = 0; k < 10; ++k) row.push_back(k + 3 * 16 + 7 * 256);
  EXPECT_EQ(visited, row);
}

TEST(LightSet, RefusesASunWithoutDirection) {
  Scene scene;
  scene.suns.push_back({Vec3f::Zero(), Vec3f::Ones(), 0.01f});
  EXPECT_THROW(LightSet{scene}, Error);
}

}  // namespace
}  // namespace softreel
