#include "render/preview/depth_range.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "render/scene/ground_mesh.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// A body a little before the origin, and a camera close above a ground of a kilometre.
Scene low_camera() {
  Scene scene;
  scene.meshes = {sphere(Vec3f(0, 0.5f, 0), 0.4f, matte(0.5f))};
  scene.camera.position = Vec3f(0, 0.05f, 4);
  scene.camera.target = Vec3f(0, 0.05f, 0);
  scene.ground.emplace();
  scene.ground->size = 1000;
  return scene;
}

constexpr int kWide = 64, kHigh = 48;

DepthRange range_of(const Scene& scene) {
  return depth_range(scene.meshes, ground_mesh(*scene.ground, scene.camera, 1), {}, {},
                     camera_frame(scene.camera, kWide, kHigh));
}

/// Least depth at which rays through the picture, its corners among them, meet the plane where a coordinate has a
/// value.
float least_depth(const Camera& camera, int axis, float value) {
  const CameraFrame frame = camera_frame(camera, kWide, kHigh);
  float least = std::numeric_limits<float>::infinity();
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j) {
      const Vec3f ray = frame.window_point(static_cast<float>(i) / 8, static_cast<float>(j) / 8);
      const float depth = (value - camera.position[axis]) / ray[axis];
      if (depth > 0) least = std::min(least, depth);
    }
  return least;
}

TEST(DepthRange, BeginsBeforeTheGroundThatALowCameraSees) {
  for (const Vec3f& up : {Vec3f(0, 1, 0), Vec3f(1, 1, 0), Vec3f(-1, 0.2f, 0), Vec3f(0.3f, -1, 0)}) {
    Scene scene = low_camera();
    scene.camera.up = up;
    const float seen = least_depth(scene.camera, 1, 0);
    EXPECT_NEAR(range_of(scene).near, 0.5f * seen, 1e-3f * seen) << up.transpose();
  }
}

TEST(DepthRange, BeginsBeforeAGroundThatIsSeenFromBelow) {
  Scene scene = low_camera();
  scene.ground->height = 0.1f;
  EXPECT_LE(range_of(scene).near, least_depth(scene.camera, 1, 0.1f));
}

TEST(DepthRange, BeginsBeforeTheWallOfABackdropThatACameraLooksUpAt) {
  Scene scene = low_camera();
  scene.ground->style = GroundStyle::Sweep;  // flat for 6 m, an arc for 3 m, then the wall
  scene.camera.position = Vec3f(0, 4, -8.9f);
  scene.camera.target = Vec3f(0, 8, -9.9f);
  const DepthRange range = range_of(scene);
  const float seen = least_depth(scene.camera, 2, -9);
  EXPECT_LT(seen, 1e-3f * range.far) << "the test asks for nothing";
  EXPECT_LE(range.near, seen);
}

TEST(DepthRange, OfUsualPicturesIsThatOfTheirBodiesAndExtent) {
  for (const GroundStyle style : {GroundStyle::Plane, GroundStyle::Sweep}) {
    Scene scene = low_camera();
    scene.camera = {};
    scene.ground.emplace();
    scene.ground->style = style;
    const DepthRange range = range_of(scene);
    EXPECT_EQ(range.near, 1e-3f * range.far);
  }
}

TEST(DepthRange, KeepsTheDepthsOfFarThingsApart) {
  Scene scene = low_camera();
  scene.camera.position.y() = scene.camera.target.y() = 1e-5f;
  const DepthRange range = range_of(scene);
  EXPECT_EQ(range.near, 1e-5f * range.far);
}

}  // namespace
}  // namespace softreel
