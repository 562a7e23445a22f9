#include "render/image/png_file.h"

#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "render/image/image_io.h"
#include "tests/support/test_folder.h"

namespace softreel {
namespace {

DisplayImage noise(int width, int height) {
  DisplayImage image{width, height, {}};
  std::mt19937 random(7);
  for (int k = 0; k < 3 * width * height; ++k) image.pixels.push_back(static_cast<std::uint8_t>(random() % 61));
  return image;
}

DisplayImage read_back(const std::vector<std::uint8_t>& bytes) {
  const std::string path = testing::test_folder() / "picture.png";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return read_png(path);
}

TEST(PngFile, ReadsBackPicturesOfOneStripOfManyAndOfRowsLongerThanAStrip) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(640, 411), std::pair(3, 1000), std::pair(100000, 3)}) {
    const DisplayImage image = noise(width, height), back = read_back(encode_png(image));
    EXPECT_EQ(back.width, width);
    EXPECT_EQ(back.height, height);
    EXPECT_TRUE(back.pixels == image.pixels) << width << " x " << height;
  }
}

TEST(PngFile, HasTheSameBytesWithAnyNumberOfThreads) {
  const DisplayImage image = noise(640, 411);
  const std::vector<std::uint8_t> alone = encode_png(image);
  for (const int count : {1, 4}) {
    const Threads threads(count);
    EXPECT_TRUE(encode_png(image, &threads) == alone) << count;
  }
}

TEST(PngFile, TellsWhetherItsValuesAreLinearAndReadsThemBackAsTheyAre) {
  const std::string chunk("gAMA\x00\x01\x86\xa0", 8);
  const auto text_of = [](const std::vector<std::uint8_t>& bytes) { return std::string(bytes.begin(), bytes.end()); };
  for (const std::vector<std::uint8_t>& alpha : {std::vector<std::uint8_t>{}, std::vector<std::uint8_t>{255, 9}}) {
    DisplayImage image{2, 1, {200, 100, 50, 0, 128, 255}, alpha};
    EXPECT_NE(text_of(encode_png(image)).find("sRGB"), std::string::npos);
    EXPECT_EQ(text_of(encode_png(image)).find("gAMA"), std::string::npos);
    EXPECT_FALSE(read_back(encode_png(image)).linear);
    image.linear = true;
    const std::vector<std::uint8_t> bytes = encode_png(image);
    EXPECT_NE(text_of(bytes).find(chunk), std::string::npos);
    EXPECT_EQ(text_of(bytes).find("sRGB"), std::string::npos);
    const DisplayImage back = read_back(bytes);
    EXPECT_TRUE(back.linear);
    EXPECT_EQ(back.pixels, image.pixels);
    EXPECT_EQ(back.alpha, image.alpha);
  }
}

TEST(PngFile, IsSmallWhereThePictureIsPlain) {
  const DisplayImage plain{640, 400, std::vector<std::uint8_t>(640 * 400 * 3, 77)};
  EXPECT_LT(encode_png(plain).size(), plain.pixels.size() / 100);
}

}  // namespace
}  // namespace softreel
