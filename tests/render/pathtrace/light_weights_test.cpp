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

}  // namespace
}  // namespace softreel
