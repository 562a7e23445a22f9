#include "render/image/image_compare.h"

#include <gtest/gtest.h>

namespace softreel {
namespace {

DisplayImage gray(int width, int height, std::uint8_t value) {
  return {width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height), value)};
}

TEST(Compare, FindsEqualPicturesIdentical) {
  const ImageDifference d = compare(gray(20, 10, 7), gray(20, 10, 7));
  EXPECT_TRUE(d.identical);
  EXPECT_EQ(d.rmse, 0);
  EXPECT_EQ(d.block_error, 0);
}

TEST(Compare, ReportsSizesApart) {
  const ImageDifference d = compare(gray(20, 10, 7), gray(10, 20, 7));
  EXPECT_FALSE(d.same_size);
  EXPECT_FALSE(d.identical);
}

TEST(Compare, MeasuresAnOffsetExactly) {
  const ImageDifference d = compare(gray(13, 9, 100), gray(13, 9, 151));
  EXPECT_DOUBLE_EQ(d.rmse, 0.2);
  EXPECT_DOUBLE_EQ(d.max_error, 0.2);
  EXPECT_DOUBLE_EQ(d.block_error, 0.2);
}

TEST(Compare, SeesAMovedEdgeAndForgivesNoise) {
  DisplayImage edge = gray(32, 32, 0), moved = edge, noisy = edge;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto k = static_cast<std::size_t>(3 * (32 * y + x) + c);
        edge.pixels[k] = x < 16 ? 50 : 200;
        moved.pixels[k] = x < 18 ? 50 : 200;
        noisy.pixels[k] = static_cast<std::uint8_t>(edge.pixels[k] + ((x + y) % 2 == 0 ? 20 : -20));
      }
  EXPECT_GT(compare(edge, moved).block_error, 0.1);
  EXPECT_EQ(compare(edge, moved).worst_x, 16);
  EXPECT_LT(compare(edge, noisy).block_error, 1e-9);
  EXPECT_GT(compare(edge, noisy).rmse, 0.07);
}

}  // namespace
}  // namespace softreel
