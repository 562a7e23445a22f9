#include "render/preview/lamp_shapes.h"

#include <cmath>
#include <numbers>

#include "render/preview/near_limit.h"

namespace softreel {
namespace {

constexpr int kRound = 64;  ///< sides of what is round
constexpr int kRings = 32;  ///< of a sphere, from pole to pole

/// A point of the unit circle.
Vec2f on_circle(int k) {
  const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(k % kRound) / kRound;
  return {std::cos(angle), std::sin(angle)};
}

Vec3f on_sphere(int ring, int k) {
  const float angle = std::numbers::pi_v<float> * static_cast<float>(ring) / kRings;
  const Vec2f around = on_circle(k);
  return {std::sin(angle) * around.x(), std::sin(angle) * around.y(), std::cos(angle)};
}

void add_lamp(const AreaLight& lamp, std::vector<LampCorner>& corners) {
  const auto add = [&](const Vec3f& position) { corners.push_back({position, lamp.radiance}); };
  const auto in_plane = [&](float x, float y) -> Vec3f { return lamp.center + x * lamp.u + y * lamp.v; };
  switch (lamp.shape) {
    case LampShape::Rectangle:
      for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}})
        add(in_plane(static_cast<float>(x), static_cast<float>(y)));
      return;
    case LampShape::Disk:
      for (int k = 0; k < kRound; ++k) {
        add(lamp.center);
        for (const int side : {k, k + 1}) add(in_plane(on_circle(side).x(), on_circle(side).y()));
      }
      return;
    case LampShape::Sphere:
      for (int ring = 0; ring < kRings; ++ring)
        for (int k = 0; k < kRound; ++k)
          for (const auto& [below, beside] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
            add(lamp.center + lamp.u.norm() * on_sphere(ring + below, k + beside));
  }
}

/// One bit for each side of the picture that a point lies beyond, and for behind the camera.
unsigned beside_bits(const Eigen::Vector4f& clip) {
  unsigned bits = clip.w() < kNearest ? 1U : 0U;
  for (int axis = 0; axis < 2; ++axis) {
    if (clip[axis] < -clip.w()) bits |= 2U << (2 * axis);
    if (clip[axis] > clip.w()) bits |= 4U << (2 * axis);
  }
  return bits;
}

}  // namespace

std::vector<LampCorner> visible_lamps(const std::vector<AreaLight>& lamps) {
  std::vector<LampCorner> corners;
  for (const AreaLight& lamp : lamps)
    if (lamp.visible) add_lamp(lamp, corners);
  return corners;
}

std::vector<OverlayVertex> lamp_triangles(const std::vector<LampCorner>& lamps,
                                          const Eigen::Matrix4f& clip_from_world) {
  std::vector<OverlayVertex> triangles;
  for (const LampCorner& corner : lamps)
    triangles.push_back({clip_from_world * corner.position.homogeneous(), Vec2f::Zero(), corner.radiance});
  return triangles;
}

void add_seen(SeenRegion& region, const std::vector<OverlayVertex>& triangles) {
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const Eigen::Vector4f &a = triangles[t].clip, &b = triangles[t + 1].clip, &c = triangles[t + 2].clip;
    if ((beside_bits(a) & beside_bits(b) & beside_bits(c)) != 0) continue;
    for (const Eigen::Vector4f& clip : {a, b, c}) region.add(clip);
  }
}

}  // namespace softreel
