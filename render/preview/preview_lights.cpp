#include "render/preview/preview_lights.h"

#include <algorithm>
#include <numbers>
#include <numeric>

#include <Eigen/Geometry>

namespace softreel {
namespace {

float luminance(const Vec3f& c) {
  return Vec3f(0.2126f, 0.7152f, 0.0722f).dot(c);
}

Vec3f middle_of(const std::vector<MotionMesh>& meshes) {
  Eigen::AlignedBox3f box;
  for (const MotionMesh& mesh : meshes)
    for (const Vec3f& p : mesh.times.back().positions) box.extend(p);
  return box.isEmpty() ? Vec3f(Vec3f::Zero()) : Vec3f(box.center());
}

/// Irradiance of a surface that faces the lamp, up to a factor; a lamp that is turned away sends nothing.
float strength_at(const Vec3f& point, const AreaLight& lamp) {
  const Vec3f to = point - lamp.center;
  const float squared = to.squaredNorm(), area = seen_area(lamp);
  float facing = 1;
  if (lamp.shape != LampShape::Sphere && squared > 0)
    facing = std::max(0.0f, lamp.u.cross(lamp.v).normalized().dot(to.normalized()));
  return luminance(lamp.radiance) * area * facing / (squared + 0.25f * area);
}

/// Indices of the `most` largest values, rising; of equal ones the first.
std::vector<int> largest(const std::vector<float>& values, int most) {
  std::vector<int> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  if (static_cast<int>(order.size()) <= most) return order;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return values[static_cast<std::size_t>(a)] > values[static_cast<std::size_t>(b)];
  });
  order.resize(static_cast<std::size_t>(most));
  std::sort(order.begin(), order.end());
  return order;
}

}  // namespace

PreviewLights preview_lights(const Scene& scene) {
  const bool choose = scene.area_lights.size() > static_cast<std::size_t>(kMaxPreviewLamps);
  const Vec3f middle = choose ? middle_of(scene.meshes) : Vec3f(Vec3f::Zero());
  std::vector<float> lamps, suns;
  for (const AreaLight& lamp : scene.area_lights) lamps.push_back(strength_at(middle, lamp));
  for (const SunLight& sun : scene.suns) suns.push_back(luminance(sun.irradiance));
  return {largest(lamps, kMaxPreviewLamps), largest(suns, kMaxPreviewSuns)};
}

int lights_left_out(const Scene& scene) {
  const auto beyond = [](std::size_t count, int most) { return std::max(0, static_cast<int>(count) - most); };
  return beyond(scene.area_lights.size(), kMaxPreviewLamps) + beyond(scene.suns.size(), kMaxPreviewSuns);
}

float seen_area(const AreaLight& lamp) {
  switch (lamp.shape) {
    case LampShape::Rectangle:
      return 4 * lamp.u.cross(lamp.v).norm();
    case LampShape::Disk:
      return std::numbers::pi_v<float> * lamp.u.cross(lamp.v).norm();
    case LampShape::Sphere:
      break;
  }
  return std::numbers::pi_v<float> * lamp.u.squaredNorm();
}

}  // namespace softreel
