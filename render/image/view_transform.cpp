#include "render/image/view_transform.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace softreel {

namespace {

/// Highlights above kKnee are compressed towards white by the brightest channel, so that hues stay, and lose colour the
/// brighter they are, as film does; below it colours are as they are. (The curve of Khronos' PBR Neutral tone mapper,
/// 2024, without its lift of the darks.)
Vec3f filmic(const Vec3f& linear) {
  constexpr float kKnee = 0.76f, kFade = 0.15f;
  const Vec3f c = linear.cwiseMax(0.0f);
  const float peak = c.maxCoeff();
  if (peak <= kKnee) return c;
  constexpr float kRoom = 1 - kKnee;
  const float compressed = 1 - kRoom * kRoom / (peak + kRoom - kKnee);
  const float whiteness = 1 - 1 / (kFade * (peak - compressed) + 1);
  return (1 - whiteness) * (compressed / peak) * c + Vec3f::Constant(whiteness * compressed);
}

std::uint8_t to_byte(float display_linear) {
  return static_cast<std::uint8_t>(std::lround(255 * srgb_encode(display_linear)));
}

}  // namespace

float srgb_encode(float linear) {
  const float x = linear > 0 ? std::min(linear, 1.0f) : 0.0f;
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

float srgb_decode(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

Vec3f apply_view(ViewTransform view, const Vec3f& linear) {
  if (view == ViewTransform::Filmic) return filmic(linear);
  return linear.cwiseMax(0.0f).cwiseMin(1.0f);
}

DisplayImage to_display(const Image& image, ViewTransform view, float exposure) {
  const Channel *r = image.find("R"), *g = image.find("G"), *b = image.find("B");
  CHECK(r != nullptr);
  CHECK(g != nullptr);
  CHECK(b != nullptr);
  const float scale = std::exp2(exposure);
  DisplayImage out{image.width, image.height, {}};
  out.pixels.resize(3 * r->pixels.size());
  const Channel* a = image.find("A");
  if (a != nullptr) out.alpha.resize(r->pixels.size());
  for (std::size_t k = 0; k < r->pixels.size(); ++k) {
    Vec3f linear(r->pixels[k], g->pixels[k], b->pixels[k]);
    if (a != nullptr) {
      const float alpha = std::clamp(a->pixels[k], 0.0f, 1.0f);
      out.alpha[k] = static_cast<std::uint8_t>(std::lround(255 * alpha));
      if (alpha > 0) linear /= alpha;
    }
    const Vec3f display = apply_view(view, scale * linear);
    for (int c = 0; c < 3; ++c) out.pixels[3 * k + static_cast<std::size_t>(c)] = to_byte(display[c]);
  }
  return out;
}

}  // namespace softreel
