/// Colour spaces of FLIP: linear RGB, an opponent space that is linear in it, and CIELAB with Hunt's adjustment.
///
/// Andersson et al. 2020 (render/image/flip.h), sec. 4.1; white is D65 as linear RGB (1, 1, 1) gives it.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/types.h"
#include "render/image/view_transform.h"

namespace softreel {

/// Linear RGB of three 8-bit sRGB values.
inline Vec3f decoded(const std::uint8_t* values) {
  const auto linear = [&](int c) { return srgb_decode(static_cast<float>(values[c]) / 255); };
  return {linear(0), linear(1), linear(2)};
}

namespace detail {

inline const Mat3f& xyz_from_rgb() {
  static const Mat3f matrix = [] {
    Mat3f m;
    m << 10135552.0f / 24577794, 8788810.0f / 24577794, 4435075.0f / 24577794,  //
        2613072.0f / 12288897, 8788810.0f / 12288897, 887015.0f / 12288897,     //
        1425312 / 73733382.0f, 8788810 / 73733382.0f, 70074185.0f / 73733382.0f;
    return m;
  }();
  return matrix;
}

/// XYZ over that of white.
inline Vec3f relative_xyz(const Vec3f& linear) {
  static const Vec3f white = xyz_from_rgb() * Vec3f::Ones();
  return (xyz_from_rgb() * linear).cwiseQuotient(white);
}

}  // namespace detail

/// YCxCz: 116 Y - 16, 500 (X - Y), 200 (Y - Z), of XYZ over white.
inline Vec3f flip_opponent(const Vec3f& linear) {
  const Vec3f xyz = detail::relative_xyz(linear);
  return {116 * xyz.y() - 16, 500 * (xyz.x() - xyz.y()), 200 * (xyz.y() - xyz.z())};
}

/// Back to linear RGB, held within the screen's [0, 1].
inline Vec3f linear_of(const Vec3f& opponent) {
  static const Vec3f white = detail::xyz_from_rgb() * Vec3f::Ones();
  static const Mat3f rgb_from_xyz = detail::xyz_from_rgb().inverse();
  const float y = (opponent.x() + 16) / 116;
  const Vec3f xyz(y + opponent.y() / 500, y, y - opponent.z() / 200);
  return (rgb_from_xyz * xyz.cwiseProduct(white)).cwiseMax(0.0f).cwiseMin(1.0f);
}

/// L*, and a*, b* times 0.01 L* (Hunt: dark colours look less colourful).
inline Vec3f flip_lab(const Vec3f& linear) {
  const auto f = [](float t) {
    constexpr float kDelta = 6.0f / 29;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29;
  };
  const Vec3f xyz = detail::relative_xyz(linear);
  const float fx = f(xyz.x()), fy = f(xyz.y()), fz = f(xyz.z());
  const float lightness = 116 * fy - 16;
  return {lightness, 0.01f * lightness * 500 * (fx - fy), 0.01f * lightness * 200 * (fy - fz)};
}

/// |dL| + length of (da, db): holds for large differences too (Abasi, Tehran and Fairchild 2020).
inline float hyab_distance(const Vec3f& a, const Vec3f& b) {
  const Vec3f d = a - b;
  return std::abs(d.x()) + std::hypot(d.y(), d.z());
}

}  // namespace softreel
