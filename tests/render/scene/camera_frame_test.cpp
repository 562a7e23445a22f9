#include "render/scene/camera_frame.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace softreel {
namespace {

TEST(CameraFrame, IsRightHandedAndOrthonormal) {
  Camera camera;
  camera.position = Vec3f(1, 2, 3);
  camera.target = Vec3f(-2, 0.5f, 1);
  camera.up = Vec3f(0.1f, 1, 0.2f);
  const CameraFrame frame = camera_frame(camera, 320, 180);
  EXPECT_NEAR(frame.right.dot(frame.up), 0, 1e-6);
  EXPECT_NEAR(frame.right.dot(frame.forward), 0, 1e-6);
  EXPECT_TRUE(frame.right.cross(frame.up).isApprox(-frame.forward, 1e-5f));
  EXPECT_GT(frame.up.dot(camera.up), 0);
}

TEST(CameraFrame, SeesTheSensorThroughTheFocalLength) {
  Camera camera;
  camera.focal_length_mm = 50;
  camera.sensor_width_mm = 36;
  const CameraFrame frame = camera_frame(camera, 200, 100);
  EXPECT_FLOAT_EQ(frame.half_width, 18.0f / 50);
  EXPECT_FLOAT_EQ(frame.half_height, 9.0f / 50);
}

TEST(CameraFrame, AWindowOntoThePictureSeesItsPixelsInTheSameDirections) {
  const CameraFrame whole = camera_frame(Camera{}, 200, 100);
  for (const PixelWindow& window : {PixelWindow{50, 10, 150, 30}, PixelWindow{-20, -10, 220, 110}}) {
    const CameraFrame part = seen_through(window, whole, 200, 100);
    for (const int x : {window.left, window.right})
      for (const int y : {window.top, window.bottom}) {
        const Vec3f seen = part.window_point(x == window.left ? -1.0f : 1.0f, y == window.top ? 1.0f : -1.0f);
        const Vec3f wanted = whole.window_point(static_cast<float>(x) / 100 - 1, 1 - static_cast<float>(y) / 50);
        EXPECT_LT((seen - wanted).norm(), 1e-6f) << x << ", " << y;
      }
  }
  EXPECT_EQ(seen_through({}, whole, 200, 100).half_width, whole.half_width) << "no window: the picture itself";
}

TEST(CameraFrame, FocusesOnTheTargetUnlessTold) {
  Camera camera;
  camera.position = Vec3f(0, 0, 4);
  camera.target = Vec3f(0, 0, 1);
  camera.f_number = 2;
  EXPECT_FLOAT_EQ(camera_frame(camera, 1, 1).focus_distance, 3);
  EXPECT_FLOAT_EQ(camera_frame(camera, 1, 1).lens_radius, 0.0125f);
  camera.focus_distance = 7;
  EXPECT_FLOAT_EQ(camera_frame(camera, 1, 1).focus_distance, 7);
}

TEST(CameraFrame, RefusesToLookNowhere) {
  Camera camera;
  camera.target = camera.position;
  EXPECT_THROW(camera_frame(camera, 1, 1), Error);
  camera.target = camera.position + camera.up;
  EXPECT_THROW(camera_frame(camera, 1, 1), Error);
  Camera flat;
  flat.focal_length_mm = 0;
  EXPECT_THROW(camera_frame(flat, 1, 1), Error);
}

}  // namespace
}  // namespace softreel
