// Multiple importance sampling against brute force: lights only and scattering only give the same picture as both.
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

std::vector<std::pair<std::string, Appearance>> looks() {
  const auto look = [](const auto& change) {
    Appearance appearance;
    appearance.base_color = Vec3f(0.8f, 0.5f, 0.3f);
    change(appearance);
    return appearance;
  };
  return {{"diffuse", look([](Appearance& a) { a.specular = 0; })},
          {"dielectric", look([](Appearance& a) { a.roughness = 0.4f; })},
          {"metal", look([](Appearance& a) { a.metallic = 1; })},
          {"coat",
           look([](Appearance& a) { a.coat = 1, a.coat_roughness = 0.4f, a.coat_color = Vec3f(0.9f, 0.5f, 0.4f); })},
          {"mirror coat", look([](Appearance& a) { a.coat = 1; })},
          {"sheen", look([](Appearance& a) { a.sheen = 1, a.sheen_roughness = 0.3f; })},
          {"rough glass", look([](Appearance& a) { a.transmission = 1, a.roughness = 0.6f; })},
          {"subsurface", look([](Appearance& a) { a.subsurface = 1, a.subsurface_radius = Vec3f::Constant(0.05f); })},
          {"all", look([](Appearance& a) {
             a.metallic = 0.2f, a.transmission = 0.3f, a.subsurface = 0.5f, a.coat = 0.5f, a.sheen = 0.5f;
           })}};
}

/// A ball on a floor, under a wide lamp and a sky that is brighter on one side.
Scene lit_scene(const Appearance& appearance) {
  auto sky = std::make_shared<EnvironmentImage>();
  sky->width = 8;
  sky->height = 4;
  for (int k = 0; k < 32; ++k) sky->pixels.push_back(Vec3f::Constant(k % 8 < 3 ? 0.8f : 0.1f));
  Scene scene;
  scene.environment.image = sky;
  scene.meshes = {square(4, 0, matte(0.5f)), sphere(Vec3f(0, 0.6f, 0), 0.5f, appearance)};
  AreaLight lamp;
  lamp.center = Vec3f(0.5f, 2, 0.5f);
  lamp.u = Vec3f(0, 0, 1);
  lamp.v = Vec3f(-1, 0, 0);
  lamp.radiance = Vec3f::Constant(2);
  scene.area_lights = {lamp};
  scene.camera.position = Vec3f(0, 1.5f, 2.2f);
  scene.camera.target = Vec3f(0, 0.5f, 0);
  return scene;
}

TEST(LightWeights, BothStrategiesAloneGiveTheSamePicture) {
  for (const auto& [name, appearance] : looks()) {
    const Scene scene = lit_scene(appearance);
    RenderParams params = small_params(20, 256);
    params.caustic_roughness = 0;
    params.max_bounces = 6;
    const Image weighed = rendered(scene, params);
    params.direct_light = DirectLight::Lights;
    const Image lights = rendered(scene, params);
    params.direct_light = DirectLight::Scattering;
    const Image scattering = rendered(scene, params);
    for (std::size_t c = 0; c < 3; ++c) {
      const double mean = mean_of(weighed.channels[c]);
      EXPECT_NEAR(mean_of(lights.channels[c]), mean, 0.015 * mean) << name << ", lights only";
      EXPECT_NEAR(mean_of(scattering.channels[c]), mean, 0.015 * mean) << name << ", scattering only";
    }
  }
}

void expect_strategies_agree(const Scene& scene, double share) {
  const auto found = [&](DirectLight by) {
    RenderParams params = small_params(8, 1024);
    params.caustic_roughness = 0;
    params.direct_light = by;
    return mean_of(rendered(scene, params).channels[0]);
  };
  const double weighed = found(DirectLight::Weighed);
  EXPECT_GT(weighed, 0.05);
  EXPECT_NEAR(found(DirectLight::Lights), weighed, share * weighed) << "lights only";
  EXPECT_NEAR(found(DirectLight::Scattering), weighed, share * weighed) << "scattering only";
}

Appearance glowing() {
  Appearance appearance = matte(0);
  appearance.emission = Vec3f::Ones();
  return appearance;
}

MotionMesh moved(MotionMesh mesh, const Vec3f& by) {
  for (Vec3f& p : mesh.times[0].positions) p += by;
  return mesh;
}

TEST(LightWeights, AgreeOnAGlowingBodyCloseBehindRoughGlass) {
  // Off the origin, where rays that pass through start farther below the glass than shadow rays stop before the body.
  const Vec3f offset(3, 0, 0);
  Appearance glass;
  glass.base_color = Vec3f::Ones();
  glass.transmission = 1;
  glass.roughness = 0.6f;
  Scene scene = scene_in_sky(0);
  scene.meshes = {moved(square(0.5f, 0, glass), offset), moved(square(0.1f, -0.05f, glowing()), offset)};
  scene.camera = camera_above(1, 0.1f);
  scene.camera.position += offset;
  scene.camera.target += offset;
  expect_strategies_agree(scene, 0.03);
}

TEST(LightWeights, AgreeWhereAGlowingBodyStandsOnTheGroundFarFromTheOrigin) {
  // A wall of 2 cm, 2 to 8 mm from what the picture shows; at 50 m the coordinates of its points are 4 um apart.
  MotionMesh wall;
  wall.appearance = glowing();
  wall.times.resize(1);
  wall.times[0].positions = {Vec3f(50, 0, -0.02f), Vec3f(50, 0, 0.02f), Vec3f(50.002f, 0.02f, 0.02f),
                             Vec3f(50.002f, 0.02f, -0.02f)};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  Scene scene = scene_in_sky(0);
  scene.meshes = {moved(square(0.5f, 0, matte(0.8f)), Vec3f(50, 0, 0)), wall};
  scene.camera.position = Vec3f(49, 1, 0);
  scene.camera.target = Vec3f(49.995f, 0, 0);
  scene.camera.sensor_width_mm = 36;
  scene.camera.focal_length_mm = 36 * 1.41f / 0.004f;
  expect_strategies_agree(scene, 0.03);
}

}  // namespace
}  // namespace softreel
