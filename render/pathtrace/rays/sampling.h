/// Small geometry of sampling: frames around a normal, disks, hemispheres and cones.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/types.h"

namespace softreel {

inline constexpr float kPi = std::numbers::pi_v<float>;

/// Rec. 709 luminance of linear RGB.
inline float luminance(const Vec3f& c) {
  return 0.2126f * c.x() + 0.7152f * c.y() + 0.0722f * c.z();
}

/// Right-handed orthonormal axes with z along a normal.
struct ShadingFrame {
  Vec3f x, y, z;

  ShadingFrame() = default;
  /// Duff et al., Building an Orthonormal Basis, Revisited, 2017.
  explicit ShadingFrame(const Vec3f& n) : z(n) {
    const float sign = std::copysign(1.0f, n.z());
    const float a = -1.0f / (sign + n.z());
    const float b = n.x() * n.y() * a;
    x = Vec3f(1.0f + sign * n.x() * n.x() * a, sign * b, -sign * n.x());
    y = Vec3f(b, sign + n.y() * n.y() * a, -n.y());
  }

  Vec3f to_local(const Vec3f& v) const { return {v.dot(x), v.dot(y), v.dot(z)}; }
  Vec3f to_world(const Vec3f& v) const { return v.x() * x + v.y() * y + v.z() * z; }
};

/// Sine and cosine of an angle in [-pi/4, pi/4] by their series; errors below 2e-7.
inline void sin_cos_eighth(float angle, float& sine, float& cosine) {
  const float s = angle * angle;
  sine = angle * (1.0f + s * (-1.0f / 6 + s * (1.0f / 120 + s * (-1.0f / 5040))));
  cosine = 1.0f + s * (-0.5f + s * (1.0f / 24 + s * (-1.0f / 720 + s * (1.0f / 40320))));
}

/// Sine and cosine of an angle within a few turns; errors below 3e-7.
inline void sin_cos(float angle, float& sine, float& cosine) {
  const float quarters = std::nearbyint(angle * (2 / kPi));
  float s = 0, c = 0;
  sin_cos_eighth((angle - quarters * 1.5703125f) - quarters * 4.83826794897e-4f, s, c);
  const int quarter = static_cast<int>(quarters) & 3;
  const bool swapped = (quarter & 1) != 0;
  sine = (quarter & 2) != 0 ? -(swapped ? c : s) : (swapped ? c : s);
  cosine = quarter == 1 || quarter == 2 ? -(swapped ? s : c) : (swapped ? s : c);
}

/// Arc cosine of x in [-1, 1]; errors below 3e-7. Without branches, for loops of it: Abramowitz and Stegun, Handbook of
/// Mathematical Functions, 1964, 4.4.46.
inline float arc_cosine(float x) {
  const float a = std::min(std::abs(x), 1.0f);
  float sum = -0.0012624911f;
  for (const float c :
       {0.0066700901f, -0.0170881256f, 0.0308918810f, -0.0501743046f, 0.0889789874f, -0.2145988016f, 1.5707963050f})
    sum = sum * a + c;
  const float angle = std::sqrt(1 - a) * sum;
  return x < 0 ? kPi - angle : angle;
}

/// Unit square to unit disk, keeping areas and neighbourhoods: Shirley and Chiu, A Low Distortion Map Between Disk and
/// Square, 1997.
inline Vec2f concentric_disk(const Vec2f& u) {
  const float a = 2 * u.x() - 1, b = 2 * u.y() - 1;
  if (a == 0 && b == 0) return Vec2f::Zero();
  float sine = 0, cosine = 0;
  if (std::abs(a) > std::abs(b)) {
    sin_cos_eighth(0.25f * kPi * (b / a), sine, cosine);
    return {a * cosine, a * sine};
  }
  sin_cos_eighth(0.25f * kPi * (a / b), sine, cosine);
  return {b * sine, b * cosine};
}

/// Direction about +z with density cos / pi.
inline Vec3f cosine_hemisphere(const Vec2f& u) {
  const Vec2f d = concentric_disk(u);
  return {d.x(), d.y(), std::sqrt(std::max(0.0f, 1.0f - d.squaredNorm()))};
}

/// Direction within an angle of +z, uniform in solid angle. one_minus_cos: of that angle (kept in this form because the
/// sun's cosine is 1 in single precision).
inline Vec3f uniform_cone(const Vec2f& u, float one_minus_cos) {
  const Vec2f d = concentric_disk(u);
  const float h = one_minus_cos * d.squaredNorm();  // 1 - cos, uniform because r^2 is
  const float scale = std::sqrt(one_minus_cos * (2 - h));
  return {d.x() * scale, d.y() * scale, 1 - h};
}

/// Weight of a sample drawn with density `a` where another strategy had density `b`: Veach's power heuristic.
inline float power_heuristic(float a, float b) {
  // Written with the ratio, so that squares of the sun's large densities do not overflow.
  if (a <= 0) return 0;
  const float r = b / a;
  return 1 / (1 + r * r);
}

}  // namespace softreel
