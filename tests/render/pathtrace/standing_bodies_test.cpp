// Bodies that stand on the ground or in it: no light comes from below, however their soles are rounded.
#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

enum class Look { Glass, Subsurface };

Appearance look_of(Look look) {
  Appearance appearance = matte(0.8f);
  if (look == Look::Glass) {
    appearance.transmission = 1;
    appearance.roughness = 0;
    appearance.ior = 1.33f;
  } else {
    appearance.subsurface = 1;
    appearance.subsurface_radius = Vec3f::Constant(0.2f);
    appearance.subsurface_scale = 1;
  }
  return appearance;
}

/// A cube of 1 m whose sole is `sole` m above the ground, under a sky that shines from below only.
Scene cube_over_light(Look look, float sole, float height) {
  Scene scene;
  scene.environment.zenith = scene.environment.horizon = Vec3f::Zero();
  scene.environment.nadir = Vec3f::Constant(100);
  scene.meshes.push_back(hard_cube(0.5f, look_of(look)));
  for (Vec3f& p : scene.meshes[0].times[0].positions) p.y() += height + sole + 0.5f;
  scene.ground = Ground{};
  scene.ground->height = height;
  scene.ground->size = 1e6f;  // little passes its rim
  scene.ground->appearance = matte(0.5f);
  scene.camera.position = Vec3f(1.3f, height + 1.5f, 2.5f);
  scene.camera.target = Vec3f(0, height + 0.4f, 0);
  return scene;
}

double brightest(const Image& image) {
  double most = 0;
  for (std::size_t c = 0; c < 3; ++c)
    for (const float value : image.channels[c].pixels) most = std::max(most, static_cast<double>(value));
  return most;
}

class StandingBodies : public testing::TestWithParam<Look> {};

TEST_P(StandingBodies, LetNoLightThroughTheGround) {
  for (const float height : {0.0f, 0.7f, -13.3f})
    for (const float sole : {0.0f, 1e-6f, -1e-6f, -0.02f, 0.02f}) {
      const Image image = rendered(cube_over_light(GetParam(), sole, height), small_params(48, 16));
      EXPECT_LT(brightest(image), 1e-3) << height << " " << sole;
    }
}

TEST_P(StandingBodies, LetNoLightThroughABackdrop) {
  for (const float along : {1.0f, 1.55f, 2.0f, 2.3f}) {
    Scene scene = cube_over_light(GetParam(), -0.3f, 0);
    for (Vec3f& p : scene.meshes[0].times[0].positions) p.z() -= along;
    scene.ground->style = GroundStyle::Sweep;
    scene.ground->sweep = 2;
    scene.camera.position = Vec3f(0, 1.5f, 2.5f);
    scene.camera.target = Vec3f(0, 0.4f, -along);
    // A few paths find their way from high up the wall past the rim of the floor.
    EXPECT_LT(mean_of(rendered(scene, small_params(48, 16)).channels[0]), 0.01) << "at " << along;
  }
}

/// Of a white body on white ground in even light; the camera sees nothing but `target` and what is within 0.35 m of it.
double mean_of_white(Scene scene, const Vec3f& eye, const Vec3f& target) {
  scene.environment.zenith = scene.environment.horizon = scene.environment.nadir = Vec3f::Ones();
  scene.meshes[0].appearance.base_color = Vec3f::Ones();
  scene.ground->appearance = matte(1);
  scene.camera.position = eye;
  scene.camera.target = target;
  scene.camera.focal_length_mm = 36 * (target - eye).norm() / 0.7f;
  scene.camera.sensor_width_mm = 36;
  RenderParams params = small_params(16, 256);
  params.max_bounces = 400;
  return mean_of(rendered(scene, params).channels[0]);
}

/// In even light a body of albedo 1 looks like the light, whatever part of it the ground hides.
TEST_P(StandingBodies, KeepTheLightOfAWhiteGround) {
  for (const float sole : {0.0f, -0.1f, 0.1f, -0.5f, -0.9f, -0.98f}) {
    const Vec3f top(0, sole + 1, 0);
    EXPECT_NEAR(mean_of_white(cube_over_light(GetParam(), sole, 0), top + Vec3f(0.5f, 2, 0.7f), top), 1, 0.01) << sole;
  }
}

/// The light comes in from below as well: under a plate as above it, and past its rim.
TEST_P(StandingBodies, AreLitUnderAPlate) {
  for (const float sole : {-2.0f, -0.5f, -0.1f, -0.02f, 0.0f})
    for (const float size : {0.4f, 1.2f, 3.0f, 30.0f}) {
      Scene scene = cube_over_light(GetParam(), sole, 0);
      scene.ground->size = size;
      const Vec3f bottom(0, sole, 0);
      EXPECT_NEAR(mean_of_white(scene, bottom + Vec3f(0.5f, -2, 0.7f), bottom), 1, 0.01) << sole << " " << size;
    }
}

INSTANTIATE_TEST_SUITE_P(Looks, StandingBodies, testing::Values(Look::Glass, Look::Subsurface),
                         [](const auto& one) { return one.param == Look::Glass ? "Glass" : "Subsurface"; });

}  // namespace
}  // namespace softreel
