#include "render/preview/picture_regions.h"

#include <gtest/gtest.h>

#include "render/scene/ground_mesh.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// Looks down the negative z axis from the origin, 45 degrees to each side; depths from 0.01 to 100.
Eigen::Matrix4f wide_view() {
  constexpr float kNear = 0.01f, kFar = 100;
  Eigen::Matrix4f clip = Eigen::Matrix4f::Zero();
  clip(0, 0) = clip(1, 1) = 1;
  clip(2, 2) = -(kFar + kNear) / (kFar - kNear);
  clip(2, 3) = -2 * kFar * kNear / (kFar - kNear);
  clip(3, 2) = -1;
  return clip;
}

TEST(PixelRects, WithoutAHoleAndTheHoleCoverTheWholeOnce) {
  const PixelRect whole{0, 0, 20, 10};
  for (const PixelRect& hole : {PixelRect{5, 3, 9, 7}, PixelRect{-4, 2, 6, 30}, PixelRect{0, 0, 20, 10},
                                PixelRect{30, 3, 40, 7}, PixelRect{8, 8, 3, 9}, PixelRect{0, 0, 20, 4}}) {
    int counts[10][20] = {};
    const auto mark = [&](const PixelRect& rect) {
      for (int y = rect.bottom; y < rect.top; ++y)
        for (int x = rect.left; x < rect.right; ++x) ++counts[y][x];
    };
    const std::vector<PixelRect> rest = without(whole, hole);
    EXPECT_LE(rest.size(), 4U);
    for (const PixelRect& rect : rest) {
      EXPECT_FALSE(rect.empty());
      mark(rect);
    }
    mark(common(whole, hole));
    for (const auto& row : counts)
      for (const int count : row) EXPECT_EQ(count, 1);
  }
}

TEST(SeenRegion, HoldsThePixelsOfABody) {
  SeenRegion region(200, 100);
  EXPECT_TRUE(region.rect(3).empty());
  add_bodies(region, {sphere(Vec3f(-2, 0, -4), 0.5f, matte(0.5f))}, wide_view());
  // Its silhouette reaches from tan(atan(1 / 2) + asin(0.5 / sqrt(20))) to the left.
  const PixelRect rect = region.rect(0);
  const double far_left = std::tan(std::atan(0.5) + std::asin(0.5 / std::sqrt(20.0)));
  EXPECT_NEAR(rect.left, 100 * (1 - far_left), 2);
  EXPECT_GT(rect.right, 100 * (1 - 0.5));
  EXPECT_LT(rect.right, 100);
  EXPECT_NEAR(rect.bottom + rect.top, 100, 2);
  const PixelRect wider = region.rect(3);
  EXPECT_EQ(wider.left, rect.left - 3);
  EXPECT_EQ(wider.top, rect.top + 3);
  add_bodies(region, {sphere(Vec3f(0, 0, 0), 0.5f, matte(0.5f))}, wide_view());
  EXPECT_EQ(region.rect(0), (PixelRect{0, 0, 200, 100})) << "around the camera";
}

TEST(ShadowRegion, HoldsTheShadowOnTheGroundAndLittleMore) {
  Scene scene;
  scene.meshes = {sphere(Vec3f(0, -1, -5), 0.2f, matte(0.5f))};
  scene.suns.resize(1);
  scene.suns[0].direction = Vec3f(1, -1, 0).normalized();
  Ground ground;
  ground.height = -2;
  const std::vector<ShadowView> views = shadow_views(scene, 4, 1024);
  const PixelRect rect = shadow_region(ground_mesh(ground, Camera{}), views, wide_view(), 200, 200);
  // The ray through the middle meets the ground at (1, -2, -5), which is seen at x = 1 / 5, y = -2 / 5.
  const PixelRect shadow{119, 59, 121, 61};
  EXPECT_EQ(common(rect, shadow), shadow);
  EXPECT_LT(rect.width(), 60);
  EXPECT_LT(rect.height(), 40);
  // Away from the ground there is no shadow on it.
  scene.suns[0].direction = Vec3f(1, 0.2f, 0).normalized();
  ground.size = 8;
  EXPECT_TRUE(
      shadow_region(ground_mesh(ground, Camera{}), shadow_views(scene, 4, 1024), wide_view(), 200, 200).empty());
}

TEST(Rim, IsSeenOnlyIfItReachesIntoThePicture) {
  Ground ground;
  ground.style = GroundStyle::Sweep;
  ground.height = -1;
  ground.sweep = 5;
  Camera camera;
  camera.position = Vec3f::Zero();
  camera.target = Vec3f(0, 0, -1);
  ground.size = 60;
  EXPECT_FALSE(may_see_rim(ground_mesh(ground, camera, 1), wide_view()));
  ground.size = 8;
  EXPECT_TRUE(may_see_rim(ground_mesh(ground, camera, 1), wide_view()));
}

}  // namespace
}  // namespace softreel
