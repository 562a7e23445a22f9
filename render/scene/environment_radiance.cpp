#include "render/scene/environment_radiance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace softreel {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Bilinear between texel centres; wraps around, ends at the poles.
Vec3f interpolated(const EnvironmentImage& image, const Vec2f& at) {
  const float x = at.x() * static_cast<float>(image.width) - 0.5f;
  const float y =
      std::clamp(at.y() * static_cast<float>(image.height) - 0.5f, 0.0f, static_cast<float>(image.height - 1));
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(y);
  const float s = x - static_cast<float>(column), t = y - static_cast<float>(row);
  const auto pixel = [&](int c, int r) {
    c = ((c % image.width) + image.width) % image.width;
    r = std::min(r, image.height - 1);
    return image
        .pixels[static_cast<std::size_t>(r) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(c)];
  };
  const Vec3f above = (1 - s) * pixel(column, row) + s * pixel(column + 1, row);
  const Vec3f below = (1 - s) * pixel(column, row + 1) + s * pixel(column + 1, row + 1);
  return (1 - t) * above + t * below;
}

}  // namespace

Vec2f environment_coordinates(const Vec3f& direction, float rotation) {
  const float azimuth = std::atan2(direction.x(), -direction.z()) + rotation;
  const float turns = azimuth / (2 * kPi) + 0.5f;
  return {turns - std::floor(turns), std::acos(std::clamp(direction.y(), -1.0f, 1.0f)) / kPi};
}

Vec3f environment_direction(const Vec2f& coordinates, float rotation) {
  const float azimuth = (coordinates.x() - 0.5f) * 2 * kPi - rotation;
  const float polar = coordinates.y() * kPi;
  return {std::sin(polar) * std::sin(azimuth), std::cos(polar), -std::sin(polar) * std::cos(azimuth)};
}

Vec3f environment_radiance(const Environment& environment, const Vec3f& direction) {
  if (environment.image)
    return environment.strength *
           interpolated(*environment.image, environment_coordinates(direction, environment.rotation));
  const float height = std::clamp(direction.y(), -1.0f, 1.0f);
  const Vec3f& end = height > 0 ? environment.zenith : environment.nadir;
  return environment.strength * (environment.horizon + std::abs(height) * (end - environment.horizon));
}

}  // namespace softreel
