#include "tool/stages/scene_stage.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "render/scene/camera_frame.h"

namespace softreel {
namespace {

CameraSettings framing(double azimuth, double elevation, double margin) {
  CameraSettings settings;
  settings.azimuth_deg = azimuth;
  settings.elevation_deg = elevation;
  settings.margin = margin;
  settings.focal_length_mm.keys = {{1, 50.0, Ease::Linear}};
  return settings;
}

/// Largest |x| and |y| of the box's corners in the picture, whose half width and height are 1.
Vec2 extent(const Camera& camera, const Bounds& box, double aspect) {
  const Vec3 position = camera.position.cast<double>();
  const Vec3 view = (camera.target.cast<double>() - position).normalized();
  const Vec3 right = view.cross(Vec3::UnitY()).normalized(), up = right.cross(view);
  const double half_width = 0.5 * camera.sensor_width_mm / camera.focal_length_mm;
  Vec2 largest = Vec2::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p((corner & 1 ? box.max : box.min).x(), (corner & 2 ? box.max : box.min).y(),
                 (corner & 4 ? box.max : box.min).z());
    const Vec3 d = p - position;
    const Vec2 at(std::abs(d.dot(right)) / d.dot(view) / half_width,
                  std::abs(d.dot(up)) / d.dot(view) / half_width * aspect);
    largest = largest.cwiseMax(at);
  }
  return largest;
}

TEST(CameraAt, FramesABoxOfAnyShapeFromAnySideWithTheMarginAskedFor) {
  const double aspect = 16.0 / 9.0;
  for (const Vec3& size : {Vec3(1, 1, 1), Vec3(3, 1, 0.2), Vec3(0.1, 2, 0.1)})
    for (const double azimuth : {0.0, 30.0, 135.0, 270.0})
      for (const double elevation : {0.0, 20.0, 60.0}) {
        const Bounds box{-0.5 * size + Vec3(5, 1, -2), 0.5 * size + Vec3(5, 1, -2)};
        const Vec2 seen = extent(camera_at(framing(azimuth, elevation, 1.25), 1, box, aspect), box, aspect);
        EXPECT_NEAR(seen.maxCoeff(), 1 / 1.25, 1e-4) << size.transpose() << " from " << azimuth << ", " << elevation;
      }
}

TEST(CameraAt, AzimuthZeroLooksFromTheFront) {
  const Camera camera = camera_at(framing(0, 0, 1), 1, {Vec3(-1, 0, -1), Vec3(1, 2, 1)}, 1.0);
  EXPECT_NEAR(camera.position.x(), 0, 1e-5);
  EXPECT_NEAR(camera.position.y(), 1, 1e-5);
  EXPECT_GT(camera.position.z(), 1);
}

TEST(CameraAt, LooksStraightDownAndUpWithTheFrontBelowOrAbove) {
  const Bounds box{Vec3(-1, 0, -1), Vec3(1, 2, 1)};
  for (const double elevation : {90.0, -90.0}) {
    const CameraFrame framed = camera_frame(camera_at(framing(0, elevation, 1), 1, box, 1), 8, 8);
    EXPECT_NEAR((framed.right - Vec3f::UnitX()).norm(), 0, 1e-5f) << elevation;
    EXPECT_NEAR((framed.up - Vec3f(0, 0, elevation > 0 ? -1 : 1)).norm(), 0, 1e-5f) << elevation;
    CameraSettings placed = framing(0, 0, 1);
    placed.mode = CameraMode::Place;
    placed.position.keys = {{1, Vec3(0, elevation > 0 ? 5 : -5, 0), Ease::Linear}};
    placed.target.keys = {{1, Vec3(0, 0, 0), Ease::Linear}};
    const CameraFrame frame = camera_frame(camera_at(placed, 1, box, 1), 8, 8);
    EXPECT_NEAR((frame.right - framed.right).norm() + (frame.up - framed.up).norm(), 0, 1e-5f) << elevation;
  }
}

TEST(CameraAt, FollowsItsKeys) {
  CameraSettings settings = framing(0, 0, 1);
  settings.mode = CameraMode::Place;
  settings.position.keys = {{1, Vec3(0, 0, 4), Ease::Linear}, {11, Vec3(10, 0, 4), Ease::Linear}};
  settings.target.keys = {{1, Vec3(0, 0, 0), Ease::Linear}};
  EXPECT_NEAR(camera_at(settings, 6, {}, 1).position.x(), 5, 1e-6);
}

TEST(CameraMotionAt, IsTheCameraAtTheTimesOfTheShutter) {
  CameraSettings settings = framing(0, 0, 1);
  settings.mode = CameraMode::Place;
  settings.position.keys = {{1, Vec3(0, 0, 4), Ease::Linear}, {11, Vec3(10, 0, 4), Ease::Linear}};
  settings.target.keys = {{1, Vec3(0, 0, 0), Ease::Linear}};
  RenderSettings render;
  render.blur_segments = 2;
  EXPECT_TRUE(camera_motion_at(settings, render, 6, {}, 1).empty()) << "no shutter";
  render.shutter = 0.5;
  const std::vector<Camera> cameras = camera_motion_at(settings, render, 6, {}, 1);
  ASSERT_EQ(cameras.size(), 3u);
  EXPECT_NEAR(cameras[0].position.x(), 4.5, 1e-6);
  EXPECT_NEAR(cameras[1].position.x(), 4.75, 1e-6);
  EXPECT_EQ(cameras[2], camera_at(settings, 6, {}, 1));
  EXPECT_TRUE(camera_motion_at(settings, render, 30, {}, 1).empty()) << "it stands";
}

/// Stands until it cuts to another place at frame 50, from where it moves by 1 m a frame.
CameraSettings camera_with_cut() {
  CameraSettings settings = framing(0, 0, 1);
  settings.mode = CameraMode::Place;
  settings.position.keys = {
      {1, Vec3(0, 0, 4), Ease::Constant}, {50, Vec3(10, 0, 4), Ease::Linear}, {60, Vec3(20, 0, 4), Ease::Linear}};
  settings.target.keys = {{1, Vec3(0, 0, 0), Ease::Constant}, {50, Vec3(9, 0, 0), Ease::Constant}};
  return settings;
}

TEST(CameraMotionAt, DoesNotFlyThroughACut) {
  const CameraSettings settings = camera_with_cut();
  RenderSettings render;
  render.blur_segments = 2;
  render.shutter = 0.5;
  EXPECT_TRUE(camera_motion_at(settings, render, 50, {}, 1).empty()) << "what it was before the cut is not seen";
  const std::vector<Camera> cameras = camera_motion_at(settings, render, 50.25, {}, 1);
  ASSERT_EQ(cameras.size(), 3u);
  EXPECT_EQ(cameras[0], camera_at(settings, 50, {}, 1));
  EXPECT_EQ(cameras[1], cameras[0]);
  EXPECT_EQ(cameras[2], camera_at(settings, 50.25, {}, 1));
  EXPECT_EQ(camera_motion_at(settings, render, 51, {}, 1)[0], camera_at(settings, 50.5, {}, 1));
}

TEST(NextCameraAt, StaysBeforeACut) {
  const CameraSettings settings = camera_with_cut();
  EXPECT_EQ(next_camera_at(settings, 49, {}, 1), camera_at(settings, 49, {}, 1));
  EXPECT_EQ(next_camera_at(settings, 50, {}, 1), camera_at(settings, 51, {}, 1));
}

TEST(CameraLedOn, GoesOnAsFromTheFrameBefore) {
  CameraSettings settings = camera_with_cut();
  settings.focal_length_mm.keys = {{50, 50.0, Ease::Linear}, {60, 60.0, Ease::Linear}};
  const Camera led = camera_led_on(settings, 60, {}, 1);
  EXPECT_EQ(led.position, Vec3f(21, 0, 4)) << "its keys end at 20";
  EXPECT_EQ(led.target, Vec3f(9, 0, 0));
  EXPECT_FLOAT_EQ(led.focal_length_mm, 60.0f * 60 / 59);
  EXPECT_EQ(camera_led_on(settings, 50, {}, 1), camera_at(settings, 50, {}, 1)) << "a cut is no pace";
  settings.target.keys = {{1, Vec3(21, 0, 4), Ease::Linear}};
  EXPECT_EQ(camera_led_on(settings, 60, {}, 1).position, Vec3f(20, 0, 4)) << "not into its target";
  settings.position.keys = {{1, Vec3(0, 0, 0.3), Ease::Linear}, {2, Vec3(0, 0, 0.2), Ease::Linear}};
  settings.target.keys = {{1, Vec3(0, 0, 0.1), Ease::Linear}};  // 2 * 0.2 - 0.3 is another double, and the same float
  EXPECT_EQ(camera_led_on(settings, 2, {}, 1).position, Vec3f(0, 0, 0.2f));
  settings.position.keys.back() = {2, Vec3(0, 0, 0.1), Ease::Linear};
  EXPECT_EQ(next_camera_at(settings, 1, {}, 1), camera_at(settings, 1, {}, 1)) << "not of a frame that it cannot show";
}

TEST(CameraAt, IsRefusedInItsTarget) {
  CameraSettings settings = camera_with_cut();
  settings.target.keys = {{1, Vec3(15, 0, 4), Ease::Constant}};
  settings.origin = {"shot.toml", 7, 1};
  EXPECT_NO_THROW(camera_at(settings, 54, {}, 1));
  try {
    camera_at(settings, 55, {}, 1);
    FAIL() << "it looks nowhere";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("shot.toml:7:1"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("frame 55"), std::string::npos) << error.what();
  }
}

TEST(LastCut, IsOfEveryTrackThatThePictureShows) {
  CameraSettings settings = framing(0, 0, 1);
  settings.focus_distance.keys = {{1, 2.0, Ease::Constant}, {7, 3.0, Ease::Constant}};
  EXPECT_FALSE(last_cut(settings, 0, 90)) << "all is sharp without an aperture";
  settings.f_number = 2;
  EXPECT_EQ(last_cut(settings, 6, 7), 7);
  EXPECT_FALSE(last_cut(settings, 7, 90));
  settings.focal_length_mm.keys = {{1, 50.0, Ease::Constant}, {9, 50.0, Ease::Constant}, {11, 35.0, Ease::Constant}};
  EXPECT_FALSE(last_cut(settings, 8, 10)) << "a key that changes nothing";
  EXPECT_EQ(last_cut(settings, 0, 90), 11);
}

TEST(PositionsBetween, LieOnTheLinesBetweenSubSteps) {
  const std::vector<Vec3> a{Vec3(0, 0, 0)}, b{Vec3(2, 0, 0)}, c{Vec3(2, 6, 0)};
  const std::vector<const std::vector<Vec3>*> steps{&a, &b, &c};
  EXPECT_EQ(positions_between(steps, -1)[0], Vec3(0, 0, 0));
  EXPECT_EQ(positions_between(steps, -0.75)[0], Vec3(1, 0, 0));
  EXPECT_EQ(positions_between(steps, -0.5)[0], Vec3(2, 0, 0));
  EXPECT_EQ(positions_between(steps, -0.25)[0], Vec3(2, 3, 0));
  EXPECT_EQ(positions_between(steps, 0)[0], Vec3(2, 6, 0));
  EXPECT_EQ(positions_between({&c}, -0.3)[0], Vec3(2, 6, 0)) << "without an earlier state nothing moves";
}

}  // namespace
}  // namespace softreel
