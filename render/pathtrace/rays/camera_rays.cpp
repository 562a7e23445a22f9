#include "render/pathtrace/rays/camera_rays.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {

float shutter_time(const ShutterCurve& curve, float u) {
  const float a = curve.opening, c = curve.closing;
  if (a == 0 && c == 0) return u;
  const float area = 1 - 0.5f * (a + c);  // under the curve, where it is 1 high
  const float opened = 0.5f * a / area, closes = 1 - 0.5f * c / area;
  if (u < opened) return std::sqrt(2 * a * area * u);
  if (u > closes) return 1 - std::sqrt(2 * c * area * (1 - u));
  return 0.5f * a + area * u;
}

CameraRays::CameraRays(const Scene& scene, int width, int height)
    : width_(width), height_(height), shutter_(scene.shutter) {
  CHECK(shutter_.opening >= 0);
  CHECK(shutter_.closing >= 0);
  CHECK(shutter_.opening + shutter_.closing <= 1);
  for (const Camera& camera : scene.camera_motion) frames_.push_back(camera_frame(camera, width, height));
  if (frames_.empty()) frames_.push_back(camera_frame(scene.camera, width, height));
}

CameraFrame CameraRays::frame_at(float time) const {
  const float at = time * static_cast<float>(frames_.size() - 1);
  const std::size_t step = std::min(static_cast<std::size_t>(at), frames_.size() - 2);
  const float t = at - static_cast<float>(step);
  const CameraFrame &a = frames_[step], &b = frames_[step + 1];
  const auto between = [t](const auto& x, const auto& y) { return x + t * (y - x); };
  CameraFrame frame;
  frame.position = between(a.position, b.position);
  frame.forward = Vec3f(between(a.forward, b.forward)).normalized();
  const Vec3f right = between(a.right, b.right);
  frame.right = (right - right.dot(frame.forward) * frame.forward).normalized();
  frame.up = frame.right.cross(frame.forward);
  frame.half_width = between(a.half_width, b.half_width);
  frame.half_height = between(a.half_height, b.half_height);
  frame.focus_distance = between(a.focus_distance, b.focus_distance);
  frame.lens_radius = between(a.lens_radius, b.lens_radius);
  return frame;
}

Ray CameraRays::ray(int x, int y, const SampleBlock& numbers) const {
  const float across = 2 * (static_cast<float>(x) + numbers[0]) / static_cast<float>(width_) - 1;
  const float up = 1 - 2 * (static_cast<float>(y) + numbers[1]) / static_cast<float>(height_);
  Ray ray;
  ray.time = shutter_time(shutter_, numbers[4]);
  if (frames_.size() == 1)
    aim(frames_.front(), across, up, numbers, ray);
  else
    aim(frame_at(ray.time), across, up, numbers, ray);
  return ray;
}

void CameraRays::aim(const CameraFrame& camera, float across, float up, const SampleBlock& numbers, Ray& ray) const {
  ray.origin = camera.position;
  Vec3f towards = camera.window_point(across, up);
  if (camera.lens_radius > 0) {
    const Vec2f lens = camera.lens_radius * concentric_disk(Vec2f(numbers[2], numbers[3]));
    const Vec3f shift = lens.x() * camera.right + lens.y() * camera.up;
    ray.origin += shift;
    towards = camera.focus_distance * towards - shift;
  }
  ray.direction = towards.normalized();
}

}  // namespace softreel
