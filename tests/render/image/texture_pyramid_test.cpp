#include "render/image/texture_pyramid.h"

#include <cstdio>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/base/srgb.h"
#include "render/image/image_io.h"

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

class TextureFiles : public testing::Test {
 protected:
  static std::string path(const std::string& name) {
    return testing::TempDir() + "/softreel_texture_" + testing::UnitTest::GetInstance()->current_test_info()->name() +
           "_" + name;
  }
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
