#include "render/pathtrace/rays/sampler.h"

#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(Sampler, EveryPairIsAZeroTwoSequence) {
  // 2^m points: one in each elementary interval of area 2^-m, whatever its shape. Pairs are (0,1), (2,3), ...
  const Sampler sampler(42, 3, 5);
  constexpr int kLog = 6, kPoints = 1 << kLog;
  for (const std::uint32_t block : {0u, 1u, 7u})
    for (std::size_t pair = 0; pair < 8; pair += 2)
      for (int split = 0; split <= kLog; ++split) {
        std::set<int> cells;
        for (std::uint32_t s = 0; s < kPoints; ++s) {
          const SampleBlock u = sampler.numbers(s, block);
          const int column = static_cast<int>(u[pair] * static_cast<float>(1 << split));
          const int row = static_cast<int>(u[pair + 1] * static_cast<float>(1 << (kLog - split)));
          cells.insert(row * (1 << split) + column);
        }
        EXPECT_EQ(cells.size(), kPoints) << "block " << block << " pair " << pair << " split " << split;
      }
}

TEST(Sampler, TwoPointsASampleAreAZeroTwoSequence) {
  // Of n samples, 2 n points: one in each elementary interval of area 1 / (2 n).
  const Sampler sampler(43, 2, 9);
  constexpr int kLog = 5, kPoints = 1 << kLog;
  for (int split = 0; split <= kLog; ++split) {
    std::set<int> cells;
    for (std::uint32_t s = 0; s < kPoints / 2; ++s)
      for (const Vec2f& u : sampler.two_points(s, 3)) {
        const int column = static_cast<int>(u.x() * static_cast<float>(1 << split));
        const int row = static_cast<int>(u.y() * static_cast<float>(1 << (kLog - split)));
        cells.insert(row * (1 << split) + column);
      }
    EXPECT_EQ(cells.size(), kPoints) << "split " << split;
  }
}

TEST(Sampler, NumbersAreInTheHalfOpenUnitInterval) {
  const Sampler sampler(7, 0, 0);
  for (std::uint32_t s = 0; s < 4096; ++s)
    for (const float u : sampler.numbers(s, 2)) {
      EXPECT_GE(u, 0);
      EXPECT_LT(u, 1);
    }
}

TEST(Sampler, PixelsPicturesAndBlocksAreIndependent) {
  // Correlation of the first numbers over many pixels with those of the neighbour, of another picture, of another
  // block.
  double product[3] = {}, n = 0;
  for (int x = 0; x < 64; ++x)
    for (int y = 0; y < 64; ++y, ++n) {
      const auto first = [](std::uint64_t picture, int px, int py, std::uint32_t block) {
        return static_cast<double>(Sampler(picture, px, py).numbers(0, block)[0]) - 0.5;
      };
      const double here = first(1, x, y, 0);
      product[0] += here * first(1, x + 1, y, 0);
      product[1] += here * first(2, x, y, 0);
      product[2] += here * first(1, x, y, 1);
    }
  for (const double sum : product) EXPECT_LT(std::abs(sum / n), 4.0 / 12 / std::sqrt(n));
}

TEST(Sampler, IntegratesASmoothFunctionFasterThanChance) {
  // Error of the mean of x y over n points: n^-1 or better for scrambled nets (Owen 1997: n^-3/2), n^-1/2 by chance.
  const auto rms_error = [](std::uint32_t n) {
    double sum = 0;
    for (int pixel = 0; pixel < 64; ++pixel) {
      const Sampler sampler(9, pixel, 0);
      double mean = 0;
      for (std::uint32_t s = 0; s < n; ++s) {
        const SampleBlock u = sampler.numbers(s, 1);
        mean += static_cast<double>(u[2]) * static_cast<double>(u[3]) / n;
      }
      sum += std::pow(mean - 0.25, 2);
    }
    return std::sqrt(sum / 64);
  };
  EXPECT_LT(rms_error(256), rms_error(16) / 16);
}

}  // namespace
}  // namespace softreel
