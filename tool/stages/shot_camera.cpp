#include "tool/stages/shot_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {

namespace {

/// The picture's upright of a camera that looks straight down or up, as if it had been tilted there from the front.
Vec3f upright(const Camera& camera) {
  const Vec3f forward = (camera.target - camera.position).normalized();
  if (!(forward.cross(Vec3f::UnitY()).norm() <= 1e-3f)) return Vec3f::UnitY();
  return Vec3f(0, 0, forward.y() < 0 ? -1.0f : 1.0f);
}

/// What a picture is taken with cannot tell the two places apart.
bool is_same_place(const Vec3& a, const Vec3& b) {
  return a.cast<float>() == b.cast<float>();
}

/// One frame on at the pace since the frame before.
Vec3 led_on(const Track<Vec3>& track, double frame) {
  const Vec3 now = track.at(frame);
  return now + (now - track.at(frame - 1));
}

}  // namespace

Camera camera_at(const CameraSettings& settings, double frame, const Bounds& rest_bounds, double aspect) {
  Camera camera;
  camera.focal_length_mm = static_cast<float>(settings.focal_length_mm.at(frame));
  camera.sensor_width_mm = static_cast<float>(settings.sensor_width_mm);
  camera.f_number = static_cast<float>(settings.f_number);
  if (!settings.focus_distance.keys.empty())
    camera.focus_distance = static_cast<float>(settings.focus_distance.at(frame));
  if (settings.mode == CameraMode::Place) {
    camera.position = settings.position.at(frame).cast<float>();
    camera.target = settings.target.at(frame).cast<float>();
    if (camera.target == camera.position)
      throw input_error(
          fmt::format("{}: the camera stands in its target at frame {}.\n"
                      "  Accepted: keys that keep the two apart. Move camera.position or camera.target.",
                      to_string(settings.origin), frame));
    camera.up = upright(camera);
    return camera;
  }
  constexpr double kRadians = std::numbers::pi / 180;
  const double azimuth = settings.azimuth_deg * kRadians, elevation = settings.elevation_deg * kRadians;
  const Vec3 toward_camera(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                           std::cos(elevation) * std::cos(azimuth));
  const Vec3 right = Vec3::UnitY().cross(toward_camera).normalized(), up = toward_camera.cross(right);
  // Slopes of the view at half the picture; the margin makes them smaller.
  const double half_width = 0.5 * settings.sensor_width_mm / (camera.focal_length_mm * settings.margin);
  const double half_height = half_width / aspect;
  const Vec3 target = rest_bounds.center() + settings.shift * rest_bounds.size().y();
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p = rest_bounds.min;
    for (int k = 0; k < 3; ++k)
      if (corner >> k & 1) p[k] = rest_bounds.max[k];
    p -= rest_bounds.center();
    const double depth = p.dot(toward_camera);
    distance =
        std::max({distance, depth + std::abs(p.dot(right)) / half_width, depth + std::abs(p.dot(up)) / half_height});
  }
  camera.target = target.cast<float>();
  camera.position = (target + distance * toward_camera).cast<float>();
  if (std::abs(toward_camera.y()) > 1 - 1e-6) camera.up = up.cast<float>();
  return camera;
}

std::optional<double> last_cut(const CameraSettings& settings, double after, double until) {
  std::optional<double> cut = last_jump(settings.focal_length_mm, after, until);
  const auto add = [&](const auto& track) { cut = std::max(cut, last_jump(track, after, until)); };
  if (settings.f_number > 0) add(settings.focus_distance);
  if (settings.mode != CameraMode::Place) return cut;
  add(settings.position);
  add(settings.target);
  return cut;
}

std::vector<Camera> camera_motion_at(const CameraSettings& settings, const RenderSettings& render, double frame,
                                     const Bounds& rest_bounds, double aspect) {
  if (!(render.shutter > 0)) return {};
  std::vector<Camera> cameras;
  // The picture is the shot after a cut: a camera between the two would fly through the scene.
  const std::optional<double> cut = last_cut(settings, frame - render.shutter, frame);
  for (int k = 0; k <= render.blur_segments; ++k) {
    const double time = render.shutter * (static_cast<double>(k) / render.blur_segments - 1);
    cameras.push_back(camera_at(settings, std::max(frame + time, cut.value_or(frame + time)), rest_bounds, aspect));
  }
  const bool stands =
      std::all_of(cameras.begin(), cameras.end(), [&](const Camera& camera) { return camera == cameras.back(); });
  return stands ? std::vector<Camera>{} : cameras;
}

Camera next_camera_at(const CameraSettings& settings, double frame, const Bounds& rest_bounds, double aspect) {
  const bool stays = last_cut(settings, frame, frame + 1) ||
                     (settings.mode == CameraMode::Place &&
                      is_same_place(settings.position.at(frame + 1), settings.target.at(frame + 1)));
  return camera_at(settings, stays ? frame : frame + 1, rest_bounds, aspect);
}

Camera camera_led_on(const CameraSettings& settings, double frame, const Bounds& rest_bounds, double aspect) {
  CameraSettings led = settings;
  if (settings.mode == CameraMode::Place) {
    led.position = constant_track(led_on(settings.position, frame));
    led.target = constant_track(led_on(settings.target, frame));
    if (is_same_place(led.position.at(0), led.target.at(0))) led = settings;
  }
  // By its ratio, as a zoom goes and stays above nothing.
  const double focal = settings.focal_length_mm.at(frame);
  led.focal_length_mm = constant_track(focal * focal / settings.focal_length_mm.at(frame - 1));
  return camera_at(last_cut(settings, frame - 1, frame) ? settings : led, frame, rest_bounds, aspect);
}

}  // namespace softreel
