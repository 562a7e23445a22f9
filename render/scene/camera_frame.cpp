#include "render/scene/camera_frame.h"

#include <cmath>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"

namespace softreel {

namespace {

void require_positive(float value, const char* name, const char* unit) {
  if (std::isfinite(value) && value > 0) return;
  throw input_error(
      fmt::format("camera.{0} = {1} gives no picture.\n"
                  "  Accepted: a finite number above 0, in {2}. Correct camera.{0}.",
                  name, value, unit));
}

}  // namespace

CameraFrame camera_frame(const Camera& camera, int width, int height) {
  CHECK(width > 0);
  CHECK(height > 0);
  require_positive(camera.focal_length_mm, "focal_length_mm", "mm");
  require_positive(camera.sensor_width_mm, "sensor_width_mm", "mm");
  const Vec3f view = camera.target - camera.position;
  const float distance = view.norm();
  if (!(std::isfinite(distance) && distance > 0))
    throw input_error(
        fmt::format("camera.target = ({}, {}, {}) is where the camera stands, so it looks nowhere.\n"
                    "  Accepted: a point away from camera.position. Move one of the two.",
                    camera.target.x(), camera.target.y(), camera.target.z()));

  CameraFrame frame;
  frame.position = camera.position;
  frame.forward = view / distance;
  const Vec3f right = frame.forward.cross(camera.up);
  if (!(right.norm() > 1e-4f * camera.up.norm()))
    throw input_error(
        fmt::format("camera.up = ({}, {}, {}) is the direction the camera looks in, so the picture has no upright.\n"
                    "  Accepted: any direction across the view. Tilt the camera or change its up direction.",
                    camera.up.x(), camera.up.y(), camera.up.z()));
  frame.right = right.normalized();
  frame.up = frame.right.cross(frame.forward);
  frame.half_width = 0.5f * camera.sensor_width_mm / camera.focal_length_mm;
  frame.half_height = frame.half_width * static_cast<float>(height) / static_cast<float>(width);
  frame.focus_distance = camera.focus_distance > 0 ? camera.focus_distance : distance;
  if (camera.f_number > 0) frame.lens_radius = 0.5e-3f * camera.focal_length_mm / camera.f_number;
  return frame;
}

CameraFrame seen_through(const PixelWindow& window, CameraFrame frame, int width, int height) {
  if (window == PixelWindow{}) return frame;
  CHECK(window.width() > 0);
  CHECK(window.height() > 0);
  const float x = frame.half_width / static_cast<float>(width), y = frame.half_height / static_cast<float>(height);
  frame.center_x += x * static_cast<float>(window.left + window.right - width);
  frame.center_y += y * static_cast<float>(height - window.top - window.bottom);
  frame.half_width = x * static_cast<float>(window.width());
  frame.half_height = y * static_cast<float>(window.height());
  return frame;
}

}  // namespace softreel
