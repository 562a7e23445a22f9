#include "render/image/flip.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "render/image/flip_color.h"

namespace softreel {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

DisplayImage constant(int width, int height, const Rgb& color) {
  DisplayImage image{width, height, {}};
  for (int k = 0; k < width * height; ++k) image.pixels.insert(image.pixels.end(), color.begin(), color.end());
  return image;
}

DisplayImage noisy(const DisplayImage& image, int amplitude) {
  std::mt19937 random(7);
  DisplayImage out = image;
  for (std::uint8_t& value : out.pixels) {
    const int step = static_cast<int>(random() % static_cast<unsigned>(2 * amplitude + 1)) - amplitude;
    value = static_cast<std::uint8_t>(std::clamp(value + step, 0, 255));
  }
  return out;
}

/// A disk of radius 12 on grey.
DisplayImage disk(float center_x) {
  DisplayImage image = constant(64, 64, {90, 100, 110});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const float dx = static_cast<float>(x) + 0.5f - center_x, dy = static_cast<float>(y) + 0.5f - 32;
      const float share = std::clamp(12.5f - std::hypot(dx, dy), 0.0f, 1.0f);
      for (std::size_t c = 0; c < 3; ++c) {
        std::uint8_t& value = image.pixels[3 * static_cast<std::size_t>(y * 64 + x) + c];
        value = static_cast<std::uint8_t>(std::lround((1 - share) * value + share * (c == 0 ? 220 : 60)));
      }
    }
  return image;
}

/// Sec. 4.1 by hand: e^0.7, of which the lower 0.4 of the range takes 0.95.
double redistributed(double distance) {
  // Green: L 87.735, a -86.18, b 83.18; blue: L 32.30, a 79.19, b -107.85; chroma times 0.01 L.
  const double da = -0.87735 * 86.18 - 0.3230 * 79.19, db = 0.87735 * 83.18 + 0.3230 * 107.85;
  const double largest = std::pow(87.735 - 32.30 + std::hypot(da, db), 0.7), e = std::pow(distance, 0.7);
  return e < 0.4 * largest ? 0.95 * e / (0.4 * largest) : 0.95 + 0.05 * (e - 0.4 * largest) / (0.6 * largest);
}

TEST(Flip, TheSamePictureHasNoErrorAtAll) {
  const DisplayImage image = noisy(disk(30), 20);
  const FlipMap map = flip(image, image);
  EXPECT_EQ(*std::max_element(map.errors.begin(), map.errors.end()), 0.0f);
  EXPECT_EQ(summarize(map).worst_block, 0);
}

TEST(Flip, ConstantColoursGiveTheValuesOfTheFormulas) {
  const auto error = [](const Rgb& a, const Rgb& b) {
    const FlipMap map = flip(constant(20, 10, a), constant(20, 10, b));
    const auto [least, most] = std::minmax_element(map.errors.begin(), map.errors.end());
    EXPECT_NEAR(*least, *most, 2e-4f) << "constant pictures have no border";
    return map.errors[0];
  };
  EXPECT_NEAR(error({0, 255, 0}, {0, 0, 255}), 1.0, 1e-4) << "the largest error there is";
  EXPECT_NEAR(error({0, 0, 0}, {255, 255, 255}), redistributed(100), 1e-3) << "L* 0 and 100";
  // Linear 0.18406 (code 119 is 0.18448): L* = 116 (0.18448)^(1/3) - 16 = 50.03; code 128 is 0.21586: L* = 53.585.
  EXPECT_NEAR(error({119, 119, 119}, {128, 128, 128}), redistributed(53.585 - 50.034), 1e-3);
}

/// FLIP at one pixel by the paper's sums over two-dimensional kernels, as they stand there; no pixel near the border.
double direct_flip(const DisplayImage& a, const DisplayImage& b, int x0, int y0) {
  constexpr double kPpd = 67;
  const auto opponent = [](const DisplayImage& image, int x, int y) {
    return flip_opponent(decoded(&image.pixels[3 * static_cast<std::size_t>(y * image.width + x)]));
  };
  const auto seen = [&](const DisplayImage& image) {
    Vec3f out;
    for (int c = 0; c < 3; ++c) {
      double sum = 0, weights = 0;
      for (int dy = -10; dy <= 10; ++dy)
        for (int dx = -10; dx <= 10; ++dx) {
          const double squared = (dx * dx + dy * dy) / (kPpd * kPpd);
          const auto g = [&](double scale, double b_) {
            return scale * std::sqrt(M_PI / b_) * std::exp(-M_PI * M_PI * squared / b_);
          };
          const double w = c == 0 ? g(1, 0.0047) : c == 1 ? g(1, 0.0053) : g(34.1, 0.04) + g(13.5, 0.025);
          sum += w * static_cast<double>(opponent(image, x0 + dx, y0 + dy)[c]);
          weights += w;
        }
      out[c] = static_cast<float>(sum / weights);
    }
    return flip_lab(linear_of(out));
  };
  // Edges (k = 0) and points (k = 1): derivatives of a Gaussian, each sign's weights normed to 1.
  const auto feature = [&](const DisplayImage& image, int k) {
    constexpr double kDeviation = 0.5 * 0.082 * kPpd;
    Vec2 response = Vec2::Zero();
    for (int axis = 0; axis < 2; ++axis) {
      double above = 0, below = 0, sum_above = 0, sum_below = 0;
      for (int dy = -9; dy <= 9; ++dy)
        for (int dx = -9; dx <= 9; ++dx) {
          const double u = (axis == 0 ? dx : dy) / kDeviation;
          const double g = std::exp(-(dx * dx + dy * dy) / (2 * kDeviation * kDeviation));
          const double w = k == 0 ? -u * g : (u * u - 1) * g;
          const double y = (static_cast<double>(opponent(image, x0 + dx, y0 + dy).x()) + 16) / 116;
          (w > 0 ? sum_above : sum_below) += w * y;
          (w > 0 ? above : below) += std::abs(w);
        }
      response[axis] = sum_above / above + sum_below / below;
    }
    return response.norm();
  };
  const double color = redistributed(static_cast<double>(hyab_distance(seen(a), seen(b))));
  double change = 0;
  for (int k = 0; k < 2; ++k) change = std::max(change, std::abs(feature(a, k) - feature(b, k)));
  return std::pow(color, 1 - std::sqrt(change / std::sqrt(2.0)));
}

TEST(Flip, EqualsThePapersTwoDimensionalSums) {
  const DisplayImage a = noisy(disk(30), 12), b = noisy(disk(32.5f), 3);
  const FlipMap map = flip(a, b);
  for (const auto& [x, y] :
       {std::pair(20, 32), std::pair(43, 30), std::pair(32, 20), std::pair(30, 30), std::pair(45, 40)})
    EXPECT_NEAR(map.errors[static_cast<std::size_t>(y * 64 + x)], direct_flip(a, b, x, y), 1e-3) << x << ", " << y;
}

TEST(Flip, IsSymmetric) {
  const DisplayImage a = noisy(disk(30), 12), b = disk(31.5f);
  EXPECT_EQ(flip(a, b).errors, flip(b, a).errors);
}

TEST(Flip, GrowsWithNoiseAndWithDistanceMoved) {
  const DisplayImage clean = disk(32);
  double last = 0;
  for (const int amplitude : {2, 6, 18, 54}) {
    const double mean = summarize(flip(clean, noisy(clean, amplitude))).mean;
    EXPECT_GT(mean, last) << amplitude;
    last = mean;
  }
  last = 0;
  for (const float shift : {0.25f, 0.5f, 1.0f, 2.0f, 4.0f}) {
    const FlipSummary summary = summarize(flip(clean, disk(32 + shift)));
    EXPECT_GT(summary.mean, last) << shift;
    EXPECT_GT(summary.worst_block, summary.mean) << "the change is at the disk, not everywhere";
    last = summary.mean;
  }
}

TEST(Flip, AViewerFartherAwaySeesLessNoise) {
  const DisplayImage clean = disk(32), bad = noisy(clean, 30);
  EXPECT_LT(summarize(flip(clean, bad, 120)).mean, summarize(flip(clean, bad, 67)).mean);
  EXPECT_LT(summarize(flip(clean, bad, 67)).mean, summarize(flip(clean, bad, 25)).mean);
}

TEST(Flip, TheWorstBlockIsWhereTheChangeIs) {
  DisplayImage changed = constant(64, 48, {128, 128, 128});
  const DisplayImage before = changed;
  for (int y = 36; y < 44; ++y)
    for (int x = 20; x < 28; ++x) changed.pixels[3 * static_cast<std::size_t>(y * 64 + x)] = 255;
  const FlipSummary summary = summarize(flip(before, changed));
  EXPECT_EQ(summary.worst_x, 16);
  EXPECT_EQ(summary.worst_y, 32);
}

TEST(Flip, OpponentColoursComeBackAndWhiteIsNeutral) {
  for (const Vec3f& rgb : {Vec3f(0.2f, 0.5f, 0.9f), Vec3f(1, 0, 0.3f), Vec3f(0, 0, 0)})
    EXPECT_LT((linear_of(flip_opponent(rgb)) - rgb).norm(), 1e-5f);
  EXPECT_LT((flip_opponent(Vec3f::Ones()) - Vec3f(100, 0, 0)).norm(), 1e-3f);
  EXPECT_LT((flip_lab(Vec3f::Ones()) - Vec3f(100, 0, 0)).norm(), 1e-3f);
}

TEST(Flip, MagmaRunsFromBlackToLightYellowAndGetsLighterAllTheWay) {
  EXPECT_LT((magma(0) - Vec3f(0, 0, 4) / 255).norm(), 0.03f);
  EXPECT_LT((magma(1) - Vec3f(252, 253, 191) / 255).norm(), 0.03f);
  EXPECT_LT((magma(0.5f) - Vec3f(183, 55, 121) / 255).norm(), 0.03f);
  float last = -1;
  for (int k = 0; k <= 64; ++k) {
    const Vec3f color = magma(static_cast<float>(k) / 64);
    const float luma = color.dot(Vec3f(0.21f, 0.72f, 0.07f));
    EXPECT_GE(luma, last) << k;
    last = luma;
  }
}

}  // namespace
}  // namespace softreel
