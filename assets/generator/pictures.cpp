#include "assets/generator/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace softreel::sculpt {

namespace {

constexpr int kPatchwork = 512, kPatch = 128, kWeave = 256, kThreads = 16;

DisplayImage empty(int size) {
  const auto edge = static_cast<std::size_t>(size);
  return {size, size, std::vector<std::uint8_t>(3 * edge * edge)};
}

void put(DisplayImage& image, int x, int y, const Vec3& code) {
  const auto at =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  for (int k = 0; k < 3; ++k)
    image.pixels[at + static_cast<std::size_t>(k)] =
        static_cast<std::uint8_t>(std::lround(255 * std::clamp(code[k], 0.0, 1.0)));
}

/// How much of the second colour a fabric shows at a place in [0, 1)^2 of its patch.
double second_share(int fabric, double u, double v) {
  const auto soft = [](double signed_distance) { return std::clamp(0.5 - 100 * signed_distance, 0.0, 1.0); };
  const auto wave = [](double x, int periods) { return std::sin(2 * std::numbers::pi * periods * x); };
  switch (fabric) {
    case 0:  // gingham: two half-transparent sets of bands
      return 0.5 * (soft(-0.02 * wave(u, 4)) + soft(-0.02 * wave(v, 4)));
    case 1: {  // dots in a shifted grid
      double share = 0;
      for (const double shift : {0.0, 0.5}) {
        const double a = 4 * u + shift, b = 4 * v + shift;
        share = std::max(share, soft((std::hypot(a - std::round(a), b - std::round(b)) - 0.21) / 4));
      }
      return share;
    }
    case 2:  // stripes
      return soft(-0.02 * (wave(u, 5) - 0.2));
    default:  // plain
      return 0;
  }
}

/// Height of a plain weave at threads x, y: what lies on top is the thread that is higher there.
double weave_height(double x, double y) {
  const auto thread = [](double across) {
    const double r = 2 * (across - std::floor(across)) - 1;
    return std::sqrt(std::max(0.0, 1 - r * r));
  };
  const double over = std::sin(std::numbers::pi * x) * std::sin(std::numbers::pi * y);
  // The warp is over where floor(x) + floor(y) is even, the weft elsewhere: heights cross at the threads' edges.
  return std::max(thread(x) + 0.8 * over, thread(y) - 0.8 * over);
}

}  // namespace

DisplayImage make_patchwork() {
  // First and second colour of each patch; no two neighbours alike, across the edges too.
  static const std::array<std::array<Vec3, 2>, 5> palette = {{{Vec3(0.80, 0.22, 0.20), Vec3(0.97, 0.93, 0.86)},
                                                              {Vec3(0.96, 0.90, 0.76), Vec3(0.20, 0.42, 0.55)},
                                                              {Vec3(0.93, 0.67, 0.25), Vec3(0.98, 0.95, 0.88)},
                                                              {Vec3(0.22, 0.45, 0.50), Vec3(0.95, 0.80, 0.50)},
                                                              {Vec3(0.40, 0.56, 0.34), Vec3(0.95, 0.93, 0.80)}}};
  DisplayImage image = empty(kPatchwork);
  for (int y = 0; y < kPatchwork; ++y)
    for (int x = 0; x < kPatchwork; ++x) {
      const int column = x / kPatch, row = y / kPatch;
      const auto& colors = palette[static_cast<std::size_t>((column + 2 * row) % 5)];
      const double u = (x % kPatch + 0.5) / kPatch, v = (y % kPatch + 0.5) / kPatch;
      const double share = second_share((column + 2 * row + row / 2) % 4, u, v);
      // The threads of the cloth, four pixels each.
      const double weave = 0.015 * std::sin(std::numbers::pi * x / 2) * std::sin(std::numbers::pi * y / 2);
      put(image, x, y, colors[0] + share * (colors[1] - colors[0]) + Vec3::Constant(weave));
    }
  return image;
}

DisplayImage make_weave_normals() {
  DisplayImage image = empty(kWeave);
  constexpr double kStep = static_cast<double>(kThreads) / kWeave, kSlope = 0.35;
  for (int y = 0; y < kWeave; ++y)
    for (int x = 0; x < kWeave; ++x) {
      const double u = (x + 0.5) * kStep, v = (y + 0.5) * kStep;
      const double across = (weave_height(u + 0.5 * kStep, v) - weave_height(u - 0.5 * kStep, v)) / kStep;
      const double down = (weave_height(u, v + 0.5 * kStep) - weave_height(u, v - 0.5 * kStep)) / kStep;
      const Vec3 normal = Vec3(-kSlope * across, kSlope * down, 1).normalized();
      put(image, x, y, (127 * normal + Vec3::Constant(128)) / 255);
    }
  return image;
}

}  // namespace softreel::sculpt
