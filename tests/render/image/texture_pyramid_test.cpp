#include "render/image/texture_pyramid.h"

#include <cstdio>
#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <zlib.h>

#include "core/base/error.h"
#include "core/base/srgb.h"
#include "render/image/image_io.h"
#include "tests/support/test_folder.h"

namespace softreel {
namespace {

std::vector<float> noise(int count) {
  std::mt19937 random(7);
  std::vector<float> values(static_cast<std::size_t>(count));
  for (float& value : values) value = static_cast<float>(random()) / 4294967296.0f;
  return values;
}

double mean_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value);
  return sum / static_cast<double>(values.size());
}

TEST(MakePyramid, EveryLevelHasTheMeanOfThePicture) {
  for (const auto& [width, height] : {std::pair(64, 64), std::pair(37, 23), std::pair(1, 13), std::pair(255, 2)}) {
    const DataTexture texture = make_pyramid(width, height, noise(width * height));
    const double mean = mean_of(texture.levels.front().texels);
    for (const auto& level : texture.levels) EXPECT_NEAR(mean_of(level.texels), mean, 2e-6) << width << " x " << height;
    EXPECT_EQ(texture.levels.back().texels.size(), 1U);
  }
}

TEST(MakePyramid, HalvesEachTexelOverTheAreaItCovers) {
  const DataTexture odd = make_pyramid(3, 1, std::vector<float>{1, 2, 6});
  EXPECT_NEAR(odd.levels[1].texels[0], 3, 1e-6);
  // Five over two: the middle texel belongs to both halves.
  const DataTexture five = make_pyramid(5, 1, std::vector<float>{1, 1, 0, 0, 0});
  EXPECT_NEAR(five.levels[1].texels[0], 0.8, 1e-6);
  EXPECT_NEAR(five.levels[1].texels[1], 0, 1e-6);
}

TEST(MakePyramid, KeepsEqualTexelsBitForBit) {
  const Vec3f color(0.1f, 0.37f, 0.9123f);
  const ColorTexture texture = make_pyramid(37, 22, std::vector<Vec3f>(37 * 22, color));
  for (const auto& level : texture.levels)
    for (const Vec3f& texel : level.texels) EXPECT_EQ(texel, color);
}

class TextureFiles : public ::testing::Test {
 protected:
  static std::string path(const std::string& name) { return testing::test_folder() / name; }
  static std::string write(const std::string& name, const std::vector<std::uint8_t>& bytes) {
    std::ofstream(path(name), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path(name);
  }
  static std::string png(const std::vector<std::uint8_t>& rgb) {
    return write("t.png", encode_png({static_cast<int>(rgb.size() / 3), 1, rgb}));
  }
  static std::string exr(const std::vector<float>& rgb) {
    return write("t.exr", encode_exr({1, 1, {{"R", {rgb[0]}}, {"G", {rgb[1]}}, {"B", {rgb[2]}}}}));
  }
};

TEST_F(TextureFiles, ColoursOfBytesAreDecodedAndDataAreNot) {
  const std::string file = png({255, 128, 0});
  const Vec3f color = read_color_texture(file).levels.front().texels[0];
  EXPECT_EQ(color, Vec3f(1, srgb_decode(128 / 255.0f), 0));
  EXPECT_FLOAT_EQ(read_data_texture(file, true).levels.front().texels[0], 128 / 255.0f) << "the green channel";
}

/// A grey PNG of one row with 16 bits a texel, its data stored without compression.
std::vector<std::uint8_t> grey_png_16(const std::vector<std::uint16_t>& row) {
  std::vector<std::uint8_t> bytes{0x89, 'P', 'N', 'G', 13, 10, 26, 10};
  const auto put = [](std::vector<std::uint8_t>& to, std::size_t value, int count) {
    for (int k = count - 1; k >= 0; --k) to.push_back(static_cast<std::uint8_t>(value >> (8 * k) & 255));
  };
  const auto chunk = [&](const char* type, const std::vector<std::uint8_t>& data) {
    put(bytes, data.size(), 4);
    const std::size_t begin = bytes.size();
    bytes.insert(bytes.end(), type, type + 4);
    bytes.insert(bytes.end(), data.begin(), data.end());
    put(bytes, crc32(0, bytes.data() + begin, static_cast<uInt>(bytes.size() - begin)), 4);
  };
  std::vector<std::uint8_t> header;
  put(header, row.size(), 4);
  put(header, 1, 4);
  header.insert(header.end(), {16, 0, 0, 0, 0});
  chunk("IHDR", header);
  const std::size_t length = 1 + 2 * row.size();
  std::vector<std::uint8_t> data{0x78, 0x01, 0x01};
  for (const std::size_t n : {length, ~length}) {
    data.push_back(static_cast<std::uint8_t>(n & 255));
    data.push_back(static_cast<std::uint8_t>(n >> 8 & 255));
  }
  data.push_back(0);
  for (const std::uint16_t value : row) put(data, value, 2);
  put(data, adler32(1, data.data() + data.size() - length, static_cast<uInt>(length)), 4);
  chunk("IDAT", data);
  chunk("IEND", {});
  return bytes;
}

TEST_F(TextureFiles, SixteenBitsKeepTheirSteps) {
  const std::string file = write("h.png", grey_png_16({0, 1, 32768, 65535}));
  EXPECT_NEAR(read_environment(file).pixels[2].x(), 0.2140, 2e-3) << "sRGB, as of 8 bits";
  const auto heights = read_data_texture(file, false).levels.front().texels;
  EXPECT_EQ(heights, std::vector<float>({0, 1 / 65535.0f, 32768 / 65535.0f, 1}));
  EXPECT_EQ(read_normal_texture(file).levels.front().texels[2], Vec3f(0, 0, 0)) << "the middle is 0";
  EXPECT_NEAR(read_color_texture(file).levels.front().texels[2].x(), srgb_decode(0.5f), 1e-4f);
}

TEST_F(TextureFiles, FloatsAreTakenAsTheyAre) {
  const std::string file = exr({0.25f, 0.5f, 0.125f});
  EXPECT_EQ(read_color_texture(file).levels.front().texels[0], Vec3f(0.25f, 0.5f, 0.125f));
  EXPECT_EQ(read_normal_texture(file).levels.front().texels[0], Vec3f(-0.5f, 0, -0.75f));
}

TEST_F(TextureFiles, TheMiddleOfANormalMapIsExactlyFlat) {
  const auto texels = read_normal_texture(png({128, 128, 255, 255, 1, 128})).levels.front().texels;
  EXPECT_EQ(texels[0], Vec3f(0, 0, 1));
  EXPECT_EQ(texels[1], Vec3f(1, -1, 0));
}

TEST_F(TextureFiles, WhatNoSurfaceCanBeIsRefusedWithThePixel) {
  const auto message = [](const auto& work) {
    try {
      work();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const std::string bright = exr({0.5f, 1.5f, 0});
  EXPECT_NE(message([&] { read_color_texture(bright); }).find("pixel (0, 0)"), std::string::npos);
  EXPECT_NE(message([&] { read_data_texture(bright, true); }).find("0 to 1"), std::string::npos);
  EXPECT_FLOAT_EQ(read_data_texture(bright, false).levels.front().texels[0], 1.5f) << "heights may be anything";
  const std::string damaged = write("d.png", {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0});
  EXPECT_NE(message([&] { read_color_texture(damaged); }).find("cannot be read"), std::string::npos);
  EXPECT_NE(message([] { read_color_texture("picture.tga"); }).find("'.tga'"), std::string::npos);
}

}  // namespace
}  // namespace softreel
