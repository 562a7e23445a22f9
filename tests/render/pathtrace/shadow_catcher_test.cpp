// A ground that shows nothing but the shadow on it.
#include "render/pathtrace/shadow_catcher.h"

#include <gtest/gtest.h>

#include "render/image/half_picture.h"
#include "render/image/image_io.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

Scene catching(float sky) {
  Scene scene = scene_in_sky(sky);
  scene.ground.emplace();
  scene.ground->shadow_catcher = true;
  scene.camera = camera_above(10, 4);
  return scene;
}

SunLight overhead() {
  SunLight sun;
  sun.irradiance = Vec3f::Constant(2);
  return sun;
}

AreaLight lamp_overhead() {
  AreaLight lamp;
  lamp.center = Vec3f(0.3f, 5, 0);
  lamp.u = Vec3f(0.5f, 0, 0);
  lamp.v = Vec3f(0, 0, 0.5f);  // u x v points down
  lamp.radiance = Vec3f::Constant(10);
  lamp.visible = false;
  return lamp;
}

TEST(ShadowCatcher, IsNothingWhereNothingShadowsIt) {
  for (const GroundStyle style : {GroundStyle::Plane, GroundStyle::Sweep}) {
    Scene scene = catching(0.5f);
    scene.ground->style = style;
    scene.suns = {overhead()};
    scene.area_lights = {lamp_overhead()};
    scene.camera.position = Vec3f(0, 2, 8);
    scene.camera.up = Vec3f(0, 1, 0);
    const Image image = rendered(scene, small_params(24, 4));
    for (const char* name : {"R", "G", "B", "A"})
      for (const float value : image.find(name)->pixels) ASSERT_EQ(value, 0) << name;
  }
}

TEST(ShadowCatcher, ShowsBodiesAsTheyAreAndNothingOfTheSurroundings) {
  Scene scene = catching(0.5f);
  scene.meshes = {sphere(Vec3f(0, 2, 0), 1, matte(0.5f))};
  const Image image = rendered(scene, small_params(32, 16));
  const std::size_t middle = 16 * 32 + 16;
  EXPECT_EQ(image.find("A")->pixels[middle], 1);
  EXPECT_GT(image.find("R")->pixels[middle], 0.2f);
  // Without ground in view: sky, which is not shown.
  scene.camera.target = Vec3f(0, 20, 0);
  scene.camera.position = Vec3f(0, 10, 0);
  const Image up = rendered(scene, small_params(4, 4));
  for (const float value : up.find("R")->pixels) EXPECT_EQ(value, 0);
  for (const float value : up.find("A")->pixels) EXPECT_EQ(value, 0);
}

TEST(ShadowCatcher, UnderASphereTheSkyIsHiddenByItsFormFactor) {
  // Seen from below: the point under a sphere of radius 1 at distance 2 loses (1/2)^2 of an even sky.
  Scene scene = catching(0.7f);
  scene.meshes = {sphere(Vec3f(0, 2, 0), 1, matte(0.5f), 48)};
  scene.camera.position = Vec3f(3, 0.3f, 0);
  scene.camera.target = Vec3f(0, 0, 0);
  scene.camera.up = Vec3f(0, 1, 0);
  scene.camera.focal_length_mm = 36 * 3 / 0.02f;
  const Image image = rendered(scene, small_params(8, 256));
  EXPECT_NEAR(mean_of(*image.find("A")), 0.25, 0.004);
  EXPECT_EQ(mean_of(*image.find("R")), 0);
}

TEST(ShadowCatcher, TakesAllLightInAnUmbraAndItsShareBesideTheSky) {
  // The sun from overhead behind a sphere; the sky gives pi L, of which (1/2)^2 is hidden.
  for (const double sky : {0.0, 0.2}) {
    Scene scene = catching(static_cast<float>(sky));
    scene.suns = {overhead()};
    scene.meshes = {sphere(Vec3f(0, 2, 0), 1, matte(0.5f), 48)};
    scene.camera.position = Vec3f(3, 0.3f, 0);
    scene.camera.target = Vec3f(0, 0, 0);
    scene.camera.up = Vec3f(0, 1, 0);
    scene.camera.focal_length_mm = 36 * 3 / 0.02f;
    const double expected = (2 + 0.25 * M_PI * sky) / (2 + M_PI * sky);
    EXPECT_NEAR(mean_of(*rendered(scene, small_params(8, 128)).find("A")), expected, 0.005);
  }
}

TEST(ShadowCatcher, BodiesBehindALampShadowNothing) {
  Scene scene = catching(0);
  scene.area_lights = {lamp_overhead()};
  scene.meshes = {sphere(Vec3f(0, 8, 0), 1, matte(0.5f))};
  scene.camera.position = Vec3f(3, 1, 0);
  scene.camera.up = Vec3f(0, 1, 0);
  const Image image = rendered(scene, small_params(16, 8));
  for (const float value : image.find("A")->pixels) ASSERT_EQ(value, 0);
}

TEST(ShadowCatcher, LampsThatTheCameraSeesAreOpaque) {
  Scene scene = catching(0.5f);
  scene.area_lights = {lamp_overhead()};
  const auto expect_seen = [&](float radiance, float alpha) {
    const Image image = rendered(scene, small_params(4, 8));
    for (const float value : image.find("R")->pixels) EXPECT_EQ(value, radiance);
    for (const float value : image.find("A")->pixels) EXPECT_EQ(value, alpha);
  };
  scene.camera = camera_above(4, 0.1f);  // below the lamp, which shines away from it
  expect_seen(0, 0);
  scene.area_lights[0].visible = true;
  scene.area_lights[0].center = Vec3f(0, 1, 0);
  std::swap(scene.area_lights[0].u, scene.area_lights[0].v);  // up: before the ground
  expect_seen(10, 1);
  scene.camera.position = Vec3f(0, 5, 0);  // before the sky
  scene.camera.target = Vec3f(0, 10, 0);
  scene.area_lights[0].center = Vec3f(0, 8, 0);
  std::swap(scene.area_lights[0].u, scene.area_lights[0].v);
  expect_seen(10, 1);
  scene.area_lights[0].visible = false;
  expect_seen(0, 0);
}

TEST(Alpha, IsKeptByHalfPicturesAndDividesTheColoursOfTheDisplay) {
  Image image{2, 1, {{"R", {0.1f, 0}}, {"G", {0.2f, 0}}, {"B", {0.25f, 0}}, {"A", {0.5f, 0.25f}}}};
  const Image again = decode_half(encode_half(image));
  ASSERT_NE(again.find("A"), nullptr);
  EXPECT_EQ(again.find("A")->pixels, image.find("A")->pixels);
  const DisplayImage display = to_display(image, ViewTransform::Standard, 0);
  EXPECT_EQ(display.alpha, (std::vector<std::uint8_t>{128, 64}));
  Image opaque{1, 1, {{"R", {0.2f}}, {"G", {0.4f}}, {"B", {0.5f}}}};
  const DisplayImage expected = to_display(opaque, ViewTransform::Standard, 0);
  EXPECT_TRUE(expected.alpha.empty());
  EXPECT_TRUE(std::equal(expected.pixels.begin(), expected.pixels.end(), display.pixels.begin()));
}

}  // namespace
}  // namespace softreel
