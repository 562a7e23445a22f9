#include "render/image/text.h"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace softreel {
namespace {

DisplayImage black(int width, int height) {
  return {width, height, std::vector<std::uint8_t>(3 * static_cast<std::size_t>(width * height))};
}

/// Columns and rows that hold anything but black.
struct Extent {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};

Extent extent(const DisplayImage& image) {
  Extent found;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      if (image.pixels[3 * static_cast<std::size_t>(y * image.width + x)] < 64) continue;
      found.left = std::min(found.left, x);
      found.right = std::max(found.right, x);
      found.top = std::min(found.top, y);
      found.bottom = std::max(found.bottom, y);
    }
  return found;
}

TEST(Text, ALineIsAsWideAndHighAsItSays) {
  for (const float height : {10.0f, 21.0f, 56.0f}) {
    DisplayImage image = black(600, 100);
    draw_text(image, 8, 12, "H0MEWARD H", {.height = height});
    const Extent found = extent(image);
    EXPECT_NEAR(found.left, 8, 0.15f * height);
    EXPECT_NEAR(found.right, 8 + text_width("H0MEWARD H", height), 0.15f * height + 1);
    EXPECT_NEAR(found.bottom - found.top + 1, height, 0.15f * height + 1);
  }
}

TEST(Text, EveryLetterHasItsOwnForm) {
  std::set<std::string> drawn;
  for (char c = '!'; c <= '~'; ++c) {
    DisplayImage image = black(24, 32);
    draw_text(image, 2, 2, std::string(1, c), {.height = 21});
    drawn.insert(std::string(image.pixels.begin(), image.pixels.end()));
  }
  EXPECT_EQ(drawn.size(), std::size_t{'~' - '!' + 1});
}

TEST(Text, NumbersOfEqualLengthAreEquallyWide) {
  for (const char* number : {"0000", "1111", "4711", "9999"})
    EXPECT_EQ(text_width(number, 14), text_width("0000", 14)) << number;
}

TEST(Text, UnknownCharactersAndBrokenUtf8AreOneBoxEach) {
  EXPECT_EQ(text_width("\u6f22", 14), text_width("M", 14));
  EXPECT_EQ(text_width("\xff", 14), text_width("M", 14));
  EXPECT_EQ(text_width("\xe6", 14), text_width("M", 14)) << "cut off in the middle";
}

TEST(Text, IsShortenedToWholeCharactersThatFit) {
  EXPECT_EQ(shortened_text("frame 24", 14, 1000), "frame 24");
  const std::string cut = shortened_text("\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5", 14, 60);
  EXPECT_LE(text_width(cut, 14), 60);
  EXPECT_TRUE(cut.ends_with("...")) << cut;
  EXPECT_EQ(cut.size() % 2, 1u) << "two bytes a letter, three dots";
  EXPECT_EQ(shortened_text("WWW", 14, 3), "");
}

TEST(Text, WhatLeavesThePictureIsCutOff) {
  DisplayImage image = black(20, 20);
  draw_text(image, -15, 12, "WWWWWWWW", {.height = 20, .halo = 4});
  fill_rectangle(image, -5, -5, 8, 8, Vec3f(1, 0, 0));
  EXPECT_EQ(image.pixels.size(), 1200U);
  EXPECT_EQ(image.pixels[0], 255);
  EXPECT_EQ(image.pixels[3 * 3], 0) << "three columns are in the picture, not four";
}

TEST(Text, AHaloDarkensBrightSurroundings) {
  DisplayImage image = black(60, 30);
  std::fill(image.pixels.begin(), image.pixels.end(), std::uint8_t{255});
  draw_text(image, 8, 6, "||", {.height = 14, .halo = 3});
  EXPECT_LT(*std::min_element(image.pixels.begin(), image.pixels.end()), 100);
}

}  // namespace
}  // namespace softreel
