#include "render/image/image_io.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/test_folder.h"

namespace softreel {
namespace {

std::string written(const std::string& name, const std::vector<std::uint8_t>& bytes) {
  const std::string path = testing::test_folder() / name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return path;
}

DisplayImage some_picture() {
  DisplayImage image{5, 3, {}};
  for (int k = 0; k < 45; ++k) image.pixels.push_back(static_cast<std::uint8_t>(k * 37));
  return image;
}

Image some_channels() {
  Image image{4, 3, {}};
  for (const char* name : {"R", "G", "B", "albedo.R", "depth.Z"}) {
    Channel channel{name, {}};
    for (int k = 0; k < 12; ++k)
      channel.pixels.push_back(static_cast<float>(k) * 0.37f - std::exp(static_cast<float>(k)));
    image.channels.push_back(channel);
  }
  image.channels[4].pixels[3] = std::numeric_limits<float>::infinity();
  return image;
}

/// A Radiance file of one row, flat RGBE pixels.
std::vector<std::uint8_t> tiny_hdr() {
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  for (const int byte : {128, 64, 32, 129, 128, 128, 128, 131}) bytes.push_back(static_cast<std::uint8_t>(byte));
  return bytes;
}

TEST(Png, ReadsBackWhatItWrote) {
  const DisplayImage image = some_picture();
  const DisplayImage back = read_png(written("softreel_io.png", encode_png(image)));
  EXPECT_EQ(back.width, 5);
  EXPECT_EQ(back.height, 3);
  EXPECT_EQ(back.pixels, image.pixels);
}

TEST(Png, KeepsItsTransparencyWhichAnEnvironmentTakesForLessLight) {
  DisplayImage image{2, 1, {200, 100, 50, 200, 100, 50}};
  image.alpha = {255, 0};
  const std::string path = written("softreel_alpha.png", encode_png(image));
  const DisplayImage back = read_png(path);
  EXPECT_EQ(back.pixels, image.pixels);
  EXPECT_EQ(back.alpha, image.alpha);
  EXPECT_EQ(over_grey(back).pixels, (std::vector<std::uint8_t>{200, 100, 50, 128, 128, 128}));
  const EnvironmentImage light = read_environment(path);
  EXPECT_GT(light.pixels[0].minCoeff(), 0);
  EXPECT_EQ(light.pixels[1], Vec3f(0, 0, 0));
}

TEST(Exr, KeepsWhereACropOrAnOverscanLiesInThePicture) {
  Image image = some_channels();
  image.left = -2;
  image.top = 5;
  image.full_width = 20;
  image.full_height = 10;
  const Image back = read_exr(written("softreel_window.exr", encode_exr(image)));
  EXPECT_EQ(back.width, 4);
  EXPECT_EQ(back.left, -2);
  EXPECT_EQ(back.top, 5);
  EXPECT_EQ(back.full_width, 20);
  EXPECT_EQ(back.full_height, 10);
  EXPECT_EQ(back.find("R")->pixels, image.channels[0].pixels);
}

TEST(Exr, ReadsBackEveryChannelBitForBit) {
  Image image = some_channels();
  image.attributes["cryptomatte/1234567/conversion"] = "uint32_to_float32";
  const Image back = read_exr(written("softreel_io.exr", encode_exr(image)));
  EXPECT_EQ(back.attributes.at("cryptomatte/1234567/conversion"), "uint32_to_float32");
  ASSERT_EQ(back.channels.size(), image.channels.size());
  EXPECT_EQ(back.width, 4);
  EXPECT_EQ(back.height, 3);
  for (const Channel& channel : image.channels) {
    ASSERT_NE(back.find(channel.name), nullptr) << channel.name;
    EXPECT_EQ(back.find(channel.name)->pixels, channel.pixels);
  }
}

TEST(Encoders, GiveTheSameBytesForTheSamePixels) {
  EXPECT_EQ(encode_png(some_picture()), encode_png(some_picture()));
  EXPECT_EQ(encode_exr(some_channels()), encode_exr(some_channels()));
}

TEST(ReadEnvironment, DecodesEachFormat) {
  const EnvironmentImage hdr = read_environment(written("softreel_io.hdr", tiny_hdr()));
  ASSERT_EQ(hdr.pixels.size(), 2u);
  EXPECT_TRUE(hdr.pixels[0].isApprox(Vec3f(1, 0.5f, 0.25f), 1e-5f));
  EXPECT_TRUE(hdr.pixels[1].isApprox(Vec3f(4, 4, 4), 1e-5f));
  const EnvironmentImage png = read_environment(written("softreel_white.PNG", encode_png({1, 1, {255, 188, 0}})));
  EXPECT_NEAR(png.pixels[0].x(), 1, 1e-6);
  EXPECT_NEAR(png.pixels[0].y(), 0.5, 3e-3);
  const Image one{1, 1, {{"R", {7.0f}}, {"G", {8.0f}}, {"B", {9.0f}}}};
  EXPECT_EQ(read_environment(written("softreel_one.exr", encode_exr(one))).pixels[0], Vec3f(7, 8, 9));
}

TEST(ReadEnvironment, PutsTheDataOfACroppedExrWhereTheyLie) {
  Image part{2, 1, {{"R", {1.0f, 2.0f}}, {"G", {3.0f, 4.0f}}, {"B", {5.0f, 6.0f}}}};
  part.left = 3;  // its second pixel is beyond the picture
  part.top = 1;
  part.full_width = 4;
  part.full_height = 2;
  const EnvironmentImage whole = read_environment(written("softreel_part.exr", encode_exr(part)));
  ASSERT_EQ(whole.width, 4);
  ASSERT_EQ(whole.height, 2);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(whole.pixels[k], k == 7 ? Vec3f(1, 3, 5) : Vec3f(0, 0, 0)) << k;
}

TEST(PictureSize, IsToldByTheHeaderAlone) {
  using Size = std::pair<int, int>;
  std::vector<std::uint8_t> hdr = tiny_hdr();
  hdr.resize(hdr.size() - 8);
  EXPECT_EQ(picture_size(written("softreel_size.hdr", hdr)), Size(2, 1));
  EXPECT_EQ(picture_size(written("softreel_size.png", encode_png(some_picture()))), Size(5, 3));
  Image part{2, 1, {{"R", {1.0f, 2.0f}}, {"G", {3.0f, 4.0f}}, {"B", {5.0f, 6.0f}}}};
  part.full_width = 4;
  part.full_height = 3;
  EXPECT_EQ(picture_size(written("softreel_size.exr", encode_exr(part))), Size(4, 3)) << "of its display window";
  for (const char* ending : {"exr", "hdr", "png", "tga"})
    EXPECT_THROW(picture_size(written(std::string("softreel_no_size.") + ending, {'n', 'o'})), Error) << ending;
}

TEST(ReadEnvironment, RefusesWhatIsNoRadiance) {
  const Image negative{1, 1, {{"R", {-1.0f}}, {"G", {0.0f}}, {"B", {0.0f}}}};
  EXPECT_THROW(read_environment(written("softreel_negative.exr", encode_exr(negative))), Error);
  EXPECT_THROW(read_environment(written("softreel_unknown.tga", {1, 2, 3})), Error);
}

TEST(Readers, NameTheFileTheyCannotRead) {
  for (const char* ending : {"exr", "hdr", "png", "jpg"}) {
    const std::string path = written(std::string("softreel_broken.") + ending, {'n', 'o', 'i', 's', 'e'});
    try {
      read_environment(path);
      FAIL() << ending;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("Accepted: "), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace softreel
