// Pictures made of pictures: reduced ones, burn-ins, contact sheets.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "render/image/burn_in.h"
#include "render/image/contact_sheet.h"
#include "render/image/reduce.h"
#include "render/image/view_transform.h"

namespace softreel {
namespace {

DisplayImage filled(int width, int height, std::uint8_t value) {
  return {width, height, std::vector<std::uint8_t>(3 * static_cast<std::size_t>(width * height), value)};
}

std::uint8_t at(const DisplayImage& image, int x, int y) {
  return image.pixels[3 * static_cast<std::size_t>(y * image.width + x)];
}

TEST(Reduced, AveragesLightNotCodes) {
  DisplayImage stripes = filled(64, 32, 0);
  for (std::size_t k = 0; k < stripes.pixels.size(); ++k)
    if (k / 3 % 2 == 0) stripes.pixels[k] = 255;
  const DisplayImage half = reduced(stripes, 32);
  ASSERT_EQ(half.width, 32);
  ASSERT_EQ(half.height, 16);
  const auto expected = static_cast<int>(std::lround(255 * srgb_encode(0.5f)));
  for (const std::uint8_t value : half.pixels) EXPECT_EQ(value, expected);
}

TEST(Reduced, KeepsConstantColoursAtAnyRatioAndNeverEnlarges) {
  for (const int width : {1, 7, 33, 99}) {
    const DisplayImage small = reduced(filled(100, 50, 173), width);
    EXPECT_EQ(small.width, width);
    for (const std::uint8_t value : small.pixels) EXPECT_EQ(value, 173);
  }
  EXPECT_EQ(reduced(filled(10, 5, 9), 20).width, 10);
}

TEST(BurnIn, ChangesTheLowerEdgeOnBothSidesOnly) {
  for (const std::uint8_t ground : {std::uint8_t{0}, std::uint8_t{255}}) {
    const DisplayImage before = filled(640, 360, ground);
    DisplayImage after = before;
    burn_in(after, {"first_pull", "24 / 96"});
    int left = 0, right = 0;
    for (int y = 0; y < 360; ++y)
      for (int x = 0; x < 640; ++x) {
        if (at(after, x, y) == ground) continue;
        EXPECT_GT(y, 320);
        EXPECT_TRUE(x < 200 || x > 500) << x;
        (x < 320 ? left : right) += 1;
      }
    EXPECT_GT(left, 100) << "on " << int{ground};
    EXPECT_GT(right, 60) << "on " << int{ground};
  }
}

TEST(BurnIn, ALongNameLeavesTheFrameLegible) {
  DisplayImage with_name = filled(320, 180, 60), without = with_name;
  burn_in(with_name, {std::string(200, 'W'), "1024 / 2048"});
  burn_in(without, {"", "1024 / 2048"});
  for (int y = 0; y < 180; ++y)
    for (int x = 245; x < 320; ++x) EXPECT_EQ(at(with_name, x, y), at(without, x, y));
}

TEST(ContactSheet, HoldsEveryPictureOnceInOrder) {
  std::vector<SheetPicture> pictures;
  for (int k = 0; k < 7; ++k) pictures.push_back({filled(320, 180, static_cast<std::uint8_t>(100 + 20 * k)), "x"});
  const DisplayImage sheet = contact_sheet(pictures, {.columns = 3, .width = 600, .title = "t"});
  std::vector<std::uint8_t> met;
  for (int y = 60; y < sheet.height; ++y)  // below the title
    for (int x = 0; x < sheet.width; ++x) {
      // A pixel with the same value all round belongs to a picture.
      const std::uint8_t value = at(sheet, x, y);
      const bool inside =
          value >= 100 && x > 1 && y > 1 && at(sheet, x - 2, y) == value && at(sheet, x, y - 2) == value;
      if (inside && std::find(met.begin(), met.end(), value) == met.end()) met.push_back(value);
    }
  EXPECT_EQ(met, (std::vector<std::uint8_t>{100, 120, 140, 160, 180, 200, 220}));
  EXPECT_LE(sheet.width, 600);
}

TEST(ContactSheet, IsTheSameOfPicturesThatWereReducedToItsCells) {
  for (const std::size_t count : {1, 2, 7})
    for (const int width : {150, 600, 5000}) {
      const SheetStyle style{.columns = 3, .width = width, .title = "t"};
      std::vector<SheetPicture> whole, small;
      for (std::size_t k = 0; k < count; ++k) {
        DisplayImage picture = filled(321, 179, 0);
        for (std::size_t p = 0; p < picture.pixels.size(); ++p)
          picture.pixels[p] = static_cast<std::uint8_t>((p * p + 31 * k) >> 3);
        small.push_back({reduced(picture, sheet_cell_width(count, style)), "x"});
        whole.push_back({std::move(picture), "x"});
      }
      const DisplayImage sheet = contact_sheet(whole, style);
      EXPECT_EQ(contact_sheet(small, style).pixels, sheet.pixels) << count << " on " << width;
      EXPECT_LE(small[0].picture.width, std::max(1, width / std::min(3, static_cast<int>(count))));
    }
}

TEST(ContactSheet, OnePictureMakesASheetOfItsOwnWidth) {
  const DisplayImage sheet = contact_sheet({{filled(100, 50, 200), ""}}, {});
  EXPECT_LT(sheet.width, 150);
  EXPECT_GE(sheet.width, 100);
}

}  // namespace
}  // namespace softreel
