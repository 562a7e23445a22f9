// Radiometry of the path tracer: pictures whose radiance is known.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "render/pathtrace/path_tracer.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

TEST(PathTracer, WhiteFurnaceIsUniform) {
  // A white body in a uniform sky reflects as much as it hides, whatever it is made of.
  for (const float metallic : {0.0f, 1.0f})
    for (const float roughness : {0.2f, 0.7f}) {
      Scene scene = scene_in_sky(0.5f);
      Appearance white;
      white.base_color = Vec3f::Ones();
      white.metallic = metallic;
      white.roughness = roughness;
      scene.meshes = {sphere(Vec3f(0, 0, 0), 1, white)};
      scene.camera = camera_above(5, 2.5f);
      const Image image = rendered(scene, small_params(24, 128));
      EXPECT_NEAR(mean_of(image.channels[0]), 0.5, 0.004) << metallic << ' ' << roughness;
      double squares = 0;
      for (const float value : image.channels[0].pixels) {
        EXPECT_NEAR(value, 0.5f, 0.06f) << metallic << ' ' << roughness;
        squares += std::pow(static_cast<double>(value) - 0.5, 2);
      }
      const double pixels = static_cast<double>(image.channels[0].pixels.size());
      EXPECT_LT(std::sqrt(squares / pixels), 0.006) << metallic << ' ' << roughness;
    }
}

TEST(PathTracer, ClearGlassInAUniformSkyIsInvisible) {
  Scene scene = scene_in_sky(0.5f);
  Appearance glass;
  glass.transmission = 1;
  glass.roughness = 0;
  scene.meshes = {sphere(Vec3f(0, 0, 0), 1, glass, 32)};
  scene.camera = camera_above(5, 2.5f);
  RenderParams params = small_params(24, 16);
  params.max_bounces = 64;
  const Image image = rendered(scene, params);
  for (const float value : image.channels[0].pixels) EXPECT_NEAR(value, 0.5f, 1e-4f);
}

/// Between y = -0.5 and 0.5, of index 1 and absorption 0.5, 1 and 2 / m: its top and its bottom.
std::vector<MotionMesh> dyed_slab(float roughness) {
  Appearance dye;
  dye.transmission = 1;
  dye.roughness = roughness;
  dye.ior = 1;
  dye.absorption = Vec3f(0.5f, 1, 2);
  MotionMesh top = square(5, 0.5f, dye), bottom = square(5, -0.5f, dye);
  for (Triangle& t : bottom.triangles) std::swap(t[0], t[1]);
  for (Vec3f& n : bottom.times[0].normals) n = -n;
  return {top, bottom};
}

/// exp(-absorption * metres) of that in each channel.
void expect_absorbed(const Image& image, double metres) {
  for (const auto& [channel, absorption] : {std::pair{0, 0.5}, {1, 1.0}, {2, 2.0}})
    EXPECT_NEAR(mean_of(image.channels[static_cast<std::size_t>(channel)]), std::exp(-absorption * metres), 1e-4);
}

TEST(PathTracer, AbsorptionFollowsBeersLaw) {
  // Straight through, also where the surface is rough: what bends no light blurs none.
  for (const float roughness : {0.0f, 0.6f}) {
    Scene scene = scene_in_sky(1);
    scene.meshes = dyed_slab(roughness);
    scene.camera = camera_above(100, 0.1f);
    expect_absorbed(rendered(scene, small_params(4, 4)), 1);
  }
}

TEST(PathTracer, DyedGlassTintsWhatItHolds) {
  Scene scene = scene_in_sky(0);
  scene.camera = camera_above(100, 0.1f);
  scene.meshes = dyed_slab(0);
  AreaLight lamp;  // in the middle, shining up
  lamp.center = Vec3f::Zero();
  lamp.u = Vec3f(1, 0, 0);
  lamp.v = Vec3f(0, 0, -1);
  ASSERT_GT(lamp.u.cross(lamp.v).y(), 0);
  lamp.radiance = Vec3f::Ones();
  scene.area_lights = {lamp};
  expect_absorbed(rendered(scene, small_params(4, 4)), 0.5);

  scene.area_lights.clear();
  Appearance glowing = matte(0);
  glowing.emission = Vec3f::Ones();
  scene.meshes.push_back(square(1, -0.25f, glowing));
  expect_absorbed(rendered(scene, small_params(4, 4)), 0.75);
}

TEST(PathTracer, LightInsideDyedGlassIsFoundAlikeByLampsAndByScattering) {
  Scene scene = scene_in_sky(0);
  scene.meshes = dyed_slab(0);
  scene.meshes.push_back(square(1, -0.4f, matte(0.8f)));
  Appearance glowing = matte(0);
  glowing.emission = Vec3f::Constant(3);
  scene.meshes.push_back(sphere(Vec3f(0.5f, 0, 0), 0.25f, glowing));
  scene.camera = camera_above(10, 0.1f);
  AreaLight lamp;  // beside it, shining down
  lamp.center = Vec3f(-0.5f, 0.2f, 0);
  lamp.u = Vec3f(0, 0, 0.2f);
  lamp.v = Vec3f(-0.2f, 0, 0);
  lamp.radiance = Vec3f::Constant(3);
  scene.area_lights = {lamp};
  const auto found = [&](DirectLight by) {
    RenderParams params = small_params(8, 1024);
    params.direct_light = by;
    return mean_of(rendered(scene, params).channels[2]);
  };
  const double weighed = found(DirectLight::Weighed);
  EXPECT_GT(weighed, 0.01);
  EXPECT_NEAR(found(DirectLight::Lights), weighed, 0.02 * weighed);
  EXPECT_NEAR(found(DirectLight::Scattering), weighed, 0.03 * weighed);
}

TEST(PathTracer, RectangleOverAFloorMatchesItsFormFactor) {
  Scene scene = scene_in_sky(0);
  scene.meshes = {square(4, 0, matte(0.8f))};
  AreaLight lamp;
  lamp.center = Vec3f(0, 1, 0);
  lamp.u = Vec3f(0, 0, 0.5f);
  lamp.v = Vec3f(-1, 0, 0);
  ASSERT_LT(lamp.u.cross(lamp.v).y(), 0);
  lamp.radiance = Vec3f::Constant(2);
  lamp.visible = false;
  scene.area_lights = {lamp};
  scene.camera = camera_above(10, 0.02f);
  const double x = std::sqrt(2.0), y = std::sqrt(1.25);
  const double factor = 4 * (1 / x * std::atan(0.5 / x) + 0.5 / y * std::atan(1 / y)) / (2 * M_PI);
  const Image image = rendered(scene, small_params(8, 64));
  EXPECT_NEAR(mean_of(image.channels[0]), 0.8 * 2 * factor, 2e-3);
}

TEST(PathTracer, SunOnATiltedFloorFollowsTheCosine) {
  for (const float diameter : {0.0f, 0.0093f}) {
    Scene scene = scene_in_sky(0);
    scene.meshes = {square(4, 0, matte(0.5f))};
    SunLight sun;
    sun.direction = Vec3f(1, -1, 0).normalized();
    sun.irradiance = Vec3f::Constant(3);
    sun.angular_diameter = diameter;
    scene.suns = {sun};
    scene.camera = camera_above(10, 1);
    EXPECT_NEAR(mean_of(rendered(scene, small_params(8, 16)).channels[0]), 0.5 / M_PI * 3 * std::sqrt(0.5), 1e-3);
  }
}

TEST(PathTracer, TwoBouncesBetweenParallelFloorAndCeilingAddUp) {
  // Between endless white planes with a glowing ceiling of albedo a, radiance of the floor is a L / (1 - a^2)... with
  // emission L on the ceiling only: floor F = a C, ceiling C = L + a F.
  Scene scene = scene_in_sky(0);
  Appearance glowing = matte(0.5f);
  glowing.emission = Vec3f::Constant(1);
  MotionMesh ceiling = square(500, 1, glowing);
  for (Triangle& t : ceiling.triangles) std::swap(t[0], t[1]);
  for (Vec3f& n : ceiling.times[0].normals) n = -n;
  scene.meshes = {square(500, 0, matte(0.5f)), ceiling};
  scene.camera = camera_above(0.9f, 0.1f);
  RenderParams params = small_params(16, 64);
  params.max_bounces = 32;
  EXPECT_NEAR(mean_of(rendered(scene, params).channels[0]), 0.5 / 0.75, 0.01);
}

TEST(PathTracer, ImageOfOneColourLightsLikeAGradientOfIt) {
  auto image = std::make_shared<EnvironmentImage>();
  image->width = 8;
  image->height = 4;
  image->pixels.assign(32, Vec3f(0.5f, 0.5f, 0.5f));
  Scene scene = scene_in_sky(0);
  scene.environment.image = image;
  Appearance white;
  white.base_color = Vec3f::Ones();
  scene.meshes = {sphere(Vec3f(0, 0, 0), 1, white)};
  scene.camera = camera_above(5, 2.5f);
  EXPECT_NEAR(mean_of(rendered(scene, small_params(16, 64)).channels[0]), 0.5, 0.01);
}

TEST(PathTracer, LampsAreSeenThroughTheirBackAndHideNothing) {
  Scene scene = scene_in_sky(0.25f);
  AreaLight lamp;
  lamp.center = Vec3f(0, 1, 0);
  lamp.u = Vec3f(10, 0, 0);
  lamp.v = Vec3f(0, 0, -10);
  ASSERT_GT(lamp.u.cross(lamp.v).y(), 0);
  scene.area_lights = {lamp};
  scene.camera = camera_above(5, 1);
  EXPECT_NEAR(mean_of(rendered(scene, small_params(4, 1)).channels[0]), 1.25, 1e-5) << "front: adds to the sky";
  scene.area_lights[0].v = -lamp.v;
  EXPECT_NEAR(mean_of(rendered(scene, small_params(4, 1)).channels[0]), 0.25, 1e-6) << "back";
}

TEST(PathTracer, NoiseFallsAtLeastWithTheRootOfTheSamples) {
  Scene scene = scene_in_sky(0.3f);
  scene.meshes = {square(4, 0, matte(0.7f)), sphere(Vec3f(0, 0.6f, 0), 0.5f, matte(0.7f))};
  AreaLight lamp;
  lamp.center = Vec3f(1, 3, 1);
  lamp.u = Vec3f(0, 0, 0.5f);
  lamp.v = Vec3f(-0.5f, 0, 0);
  lamp.radiance = Vec3f::Constant(10);
  scene.area_lights = {lamp};
  scene.camera.position = Vec3f(0, 2, 4);
  const Image exact = rendered(scene, small_params(24, 2048));
  const double few = rms_difference(rendered(scene, small_params(24, 4)).channels[0], exact.channels[0]);
  const double many = rms_difference(rendered(scene, small_params(24, 64)).channels[0], exact.channels[0]);
  EXPECT_LT(many, few / 4) << "exponent below -1/2: stratified samples";
  EXPECT_GT(many, few / 64);
}

TEST(PathTracer, BlurredCausticsKeepTheLightOfGlassWithoutFireflies) {
  // Light focused by a glass ball onto the floor. Blurring spreads it and, the
  // compensation of rough glass not being reciprocal, costs a little of it.
  Scene scene = scene_in_sky(0);
  Appearance glass;
  glass.transmission = 1;
  glass.roughness = 0;
  scene.meshes = {square(4, 0, matte(0.8f)), sphere(Vec3f(0, 0.7f, 0), 0.5f, glass)};
  AreaLight lamp;
  lamp.center = Vec3f(0, 3, 0);
  lamp.u = Vec3f(0, 0, 0.5f);
  lamp.v = Vec3f(-0.5f, 0, 0);
  lamp.radiance = Vec3f::Constant(10);
  scene.area_lights = {lamp};
  scene.camera = camera_above(6, 8);
  RenderParams params = small_params(16, 64);
  const Image blurred = rendered(scene, params);
  params.caustic_roughness = 0;
  const Image sharp = rendered(scene, params);
  EXPECT_NEAR(mean_of(blurred.channels[0]) / mean_of(sharp.channels[0]), 1, 0.15);
  const auto largest = [](const Channel& c) { return *std::max_element(c.pixels.begin(), c.pixels.end()); };
  EXPECT_LT(largest(blurred.channels[0]), largest(sharp.channels[0]));
}

TEST(PathTracer, ClampOnlyDarkens) {
  Scene scene = scene_in_sky(0.3f);
  scene.meshes = {square(4, 0, matte(0.9f)), sphere(Vec3f(0, 0.6f, 0), 0.5f, matte(0.9f))};
  scene.camera = camera_above(5, 3);
  RenderParams params = small_params(16, 16);
  const Image open = rendered(scene, params);
  params.clamp = 0.05f;
  const Image clamped = rendered(scene, params);
  for (std::size_t k = 0; k < open.channels[0].pixels.size(); ++k)
    EXPECT_LE(clamped.channels[0].pixels[k], open.channels[0].pixels[k] + 1e-6f);
  EXPECT_LT(mean_of(clamped.channels[0]), mean_of(open.channels[0]));
}

}  // namespace
}  // namespace softreel
