#include "render/image/view_transform.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "core/base/check.h"

namespace softreel {

namespace {

/// Highlights above kKnee are compressed towards white by the brightest channel, so that hues stay, and lose colour the
/// brighter they are, as film does; below it colours are as they are. (The curve of Khronos' PBR Neutral tone mapper,
/// 2024, without its lift of the darks.)
Vec3f filmic(const Vec3f& linear) {
  constexpr float kKnee = 0.76f, kFade = 0.15f;
  const Vec3f c = linear.cwiseMax(0.0f).cwiseMin(1e12f);  // white, also where the light has no number any more
  const float peak = c.maxCoeff();
  if (peak <= kKnee) return c;
  constexpr float kRoom = 1 - kKnee;
  const float compressed = 1 - kRoom * kRoom / (peak + kRoom - kKnee);
  const float whiteness = 1 - 1 / (kFade * (peak - compressed) + 1);
  return (1 - whiteness) * (compressed / peak) * c + Vec3f::Constant(whiteness * compressed);
}

/// A fit of the ACES 1.0 RRT and sRGB ODT by Stephen Hill (2015, published in M. Pettineo's BakingLab, MIT): a film
/// curve of three channels in a space where saturated lights turn to white. It is no ACES: no input transforms, no
/// dimming.
Vec3f aces_fit(const Vec3f& linear) {
  static const Mat3f into = [] {
    Mat3f m;
    m << 0.59719f, 0.35458f, 0.04823f, 0.07600f, 0.90834f, 0.01566f, 0.02840f, 0.13383f, 0.83777f;
    return m;
  }();
  static const Mat3f back = [] {
    Mat3f m;
    m << 1.60475f, -0.53108f, -0.07367f, -0.10208f, 1.10813f, -0.00605f, -0.00327f, -0.07276f, 1.07602f;
    return m;
  }();
  // Beyond this the curve is flat to the last bit, and its squares would leave the range of single.
  const Vec3f v = into * linear.cwiseMax(0.0f).cwiseMin(1e6f);
  const Eigen::Array3f a = v.array();
  const Eigen::Array3f curved = (a * (a + 0.0245786f) - 0.000090537f) / (a * (0.983729f * a + 0.4329510f) + 0.238081f);
  return (back * curved.matrix()).cwiseMax(0.0f).cwiseMin(1.0f);
}

std::uint8_t to_byte(float code) {
  return static_cast<std::uint8_t>(std::lround(255 * code));
}

/// to_byte(srgb_encode(x)) without the power: a byte's values are the floats from its first one to the next one's.
class SrgbBytes {
 public:
  SrgbBytes() {
    // Floats of 0 or more are ordered as their bits are.
    for (int code = 1; code < 256; ++code) {
      std::uint32_t below = 0, first = std::bit_cast<std::uint32_t>(1.0f);
      while (first - below > 1) {
        const std::uint32_t middle = below + (first - below) / 2;
        (to_byte(srgb_encode(std::bit_cast<float>(middle))) >= code ? first : below) = middle;
      }
      first_[static_cast<std::size_t>(code)] = std::bit_cast<float>(first);
    }
    first_[256] = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < starts_.size(); ++k)
      starts_[k] = to_byte(srgb_encode(std::bit_cast<float>(static_cast<std::uint32_t>(k + kFirst) << kShift)));
  }

  std::uint8_t operator()(float linear) const {
    if (!(linear >= first_[1])) return 0;  // what is no number too, as in srgb_encode
    if (linear >= 1) return 255;
    std::size_t code = starts_[(std::bit_cast<std::uint32_t>(linear) >> kShift) - kFirst];
    while (linear >= first_[code + 1]) ++code;
    return static_cast<std::uint8_t>(code);
  }

 private:
  /// Floats with equal sign, exponent and 7 bits of mantissa share a start: not more than a few bytes.
  static constexpr int kShift = 16;
  static constexpr std::uint32_t kFirst =
      std::bit_cast<std::uint32_t>(0x1p-13f) >> kShift;  ///< below the first of byte 1
  static constexpr std::uint32_t kEnd = std::bit_cast<std::uint32_t>(1.0f) >> kShift;
  std::array<float, 257> first_{};                    ///< least value of each byte; of byte 0 not used
  std::array<std::uint8_t, kEnd - kFirst> starts_{};  ///< byte of the least value with these bits
};

}  // namespace

Vec3f apply_view(ViewTransform view, const Vec3f& linear) {
  if (view == ViewTransform::Filmic) return filmic(linear);
  if (view == ViewTransform::AcesFit) return aces_fit(linear);
  return linear.cwiseMax(0.0f).cwiseMin(1.0f);
}

std::uint8_t srgb_byte(float linear) {
  static const SrgbBytes bytes;
  return bytes(linear);
}

DisplayImage to_display(const Image& image, ViewTransform view, float exposure, const Threads* threads) {
  const Channel *r = image.find("R"), *g = image.find("G"), *b = image.find("B");
  CHECK(r != nullptr);
  CHECK(g != nullptr);
  CHECK(b != nullptr);
  const float scale = std::exp2(exposure);
  DisplayImage out{image.width, image.height, {}};
  out.linear = view == ViewTransform::Raw;
  out.pixels.resize(3 * r->pixels.size());
  const Channel* a = image.find("A");
  if (a != nullptr) out.alpha.resize(r->pixels.size());
  const auto develop = [&](std::int64_t begin, std::int64_t end) {
    for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
      Vec3f linear(r->pixels[k], g->pixels[k], b->pixels[k]);
      if (a != nullptr) {
        const float alpha = a->pixels[k] > 0 ? std::min(a->pixels[k], 1.0f) : 0.0f;  // 0 of what is no number
        out.alpha[k] = static_cast<std::uint8_t>(std::lround(255 * alpha));
        if (alpha > 0) linear /= alpha;
      }
      linear *= scale;
      for (int c = 0; c < 3; ++c)
        if (std::isnan(linear[c])) linear[c] = 0;
      const Vec3f display = apply_view(view, linear);
      for (int c = 0; c < 3; ++c)
        out.pixels[3 * k + static_cast<std::size_t>(c)] =
            view == ViewTransform::Raw ? to_byte(display[c]) : srgb_byte(display[c]);
    }
  };
  const auto pixels = static_cast<std::int64_t>(r->pixels.size());
  constexpr std::int64_t kChunk = 1 << 15;
  if (threads != nullptr)
    threads->for_chunks(pixels, kChunk, develop);
  else
    develop(0, pixels);
  return out;
}

}  // namespace softreel
