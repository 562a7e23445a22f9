/// The sRGB curve (IEC 61966-2-1): between what light is and what pictures of 8 bits store.
#pragma once

#include <algorithm>
#include <cmath>

namespace softreel {

/// Linear to code value, both in [0, 1]; what lies outside is held at the ends.
inline float srgb_encode(float linear) {
  const float x = linear > 0 ? std::min(linear, 1.0f) : 0.0f;
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

/// Code value to linear.
inline float srgb_decode(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

}  // namespace softreel
