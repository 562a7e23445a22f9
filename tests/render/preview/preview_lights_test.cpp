#include "render/preview/preview_lights.h"

#include <gtest/gtest.h>

#include "render/preview/shadow_views.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// Small balls that shine, two metres around a body.
Scene among_lamps(int count) {
  Scene scene = scene_in_sky(0);
  scene.meshes = {sphere(Vec3f(5, 0, 0), 0.5f, matte(0.5f))};
  for (int k = 0; k < count; ++k) {
    AreaLight lamp;
    lamp.shape = LampShape::Sphere;
    lamp.center = Vec3f(7, 0, 0);
    lamp.u = Vec3f(0.1f, 0, 0);
    scene.area_lights.push_back(lamp);
  }
  return scene;
}

TEST(PreviewLights, AreAllWhereThereIsRoom) {
  Scene scene = among_lamps(kMaxPreviewLamps);
  scene.area_lights[3].radiance = Vec3f::Zero();
  scene.suns.resize(kMaxPreviewSuns);
  const PreviewLights lights = preview_lights(scene);
  ASSERT_EQ(lights.lamps.size(), static_cast<std::size_t>(kMaxPreviewLamps));
  EXPECT_EQ(lights.lamps[3], 3);
  EXPECT_EQ(lights.suns.size(), static_cast<std::size_t>(kMaxPreviewSuns));
  EXPECT_EQ(lights_left_out(scene), 0);
}

TEST(PreviewLights, OfTooManyThoseThatSendMostToTheBodiesStay) {
  Scene scene = among_lamps(kMaxPreviewLamps + 4);
  scene.area_lights[0].radiance *= 0.5f;
  scene.area_lights[1].center.x() += 1;  // farther
  scene.area_lights[2].u *= 0.5f;        // smaller
  AreaLight& turned_away = scene.area_lights[3];
  turned_away.shape = LampShape::Rectangle;
  turned_away.u = Vec3f(0, 0, 1);
  turned_away.v = Vec3f(0, -1, 0);
  ASSERT_GT(turned_away.u.cross(turned_away.v).x(), 0) << "the body is on the other side";
  const PreviewLights lights = preview_lights(scene);
  ASSERT_EQ(lights.lamps.size(), static_cast<std::size_t>(kMaxPreviewLamps));
  for (int k = 0; k < kMaxPreviewLamps; ++k) EXPECT_EQ(lights.lamps[static_cast<std::size_t>(k)], k + 4);
  EXPECT_EQ(lights_left_out(scene), 4);
}

TEST(PreviewLights, OfTooManySunsTheFaintestAreLeftOut) {
  Scene scene = among_lamps(0);
  scene.suns.resize(kMaxPreviewSuns + 1);
  scene.suns[2].irradiance = Vec3f::Constant(0.1f);
  const std::vector<int> suns = preview_lights(scene).suns;
  ASSERT_EQ(suns.size(), static_cast<std::size_t>(kMaxPreviewSuns));
  EXPECT_EQ(suns[2], 3);
  EXPECT_EQ(lights_left_out(scene), 1);
}

TEST(PreviewLights, OnlyTheyCastShadows) {
  Scene scene = among_lamps(kMaxPreviewLamps + 1);
  scene.area_lights[0].radiance *= 0.5f;
  const std::vector<ShadowView> views = shadow_views(scene, 2, 64);
  ASSERT_EQ(views.size(), 2U);
  EXPECT_EQ(views[0].light, 1);
  EXPECT_EQ(views[1].light, 2);
}

}  // namespace
}  // namespace softreel
