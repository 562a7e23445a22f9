#include "render/image/radiance_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "render/image/image_io.h"
#include "tests/support/test_folder.h"

namespace softreel {
namespace {

using SharedExponent = std::array<std::uint8_t, 4>;
using SharedExponents = std::vector<SharedExponent>;

std::string radiance_header(const std::string& size, const std::string& format = "FORMAT=32-bit_rle_rgbe\n") {
  return "#?RADIANCE\n# by hand\nEXPOSURE=2.5\n" + format + "\n" + size + "\n";
}
std::string radiance_header(int width, int height) {
  return radiance_header(fmt::format("-Y {} +X {}", height, width));
}

/// Pixels one by one, then some alike, in each row.
SharedExponents some_exponents(int width, int height) {
  SharedExponents pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int k = std::min(x, 5) + 7 * y;
      pixels.push_back({static_cast<std::uint8_t>(128 + k), static_cast<std::uint8_t>(31 * k), 3,
                        static_cast<std::uint8_t>(k == 2 ? 0 : 100 + 11 * k)});
    }
  return pixels;
}

std::string flat_rows(const SharedExponents& pixels) {
  std::string bytes;
  for (const SharedExponent& pixel : pixels) bytes.append(reinterpret_cast<const char*>(pixel.data()), 4);
  return bytes;
}

/// Calls add(first, count) for each stretch of equal values of a row.
template <typename Equal, typename Add>
void for_runs(std::size_t width, const Equal& equal, const Add& add) {
  for (std::size_t x = 0; x < width;) {
    std::size_t end = x + 1;
    while (end < width && equal(x, end)) ++end;
    add(x, end - x);
    x = end;
  }
}

std::string rows_with_runs(const SharedExponents& pixels, std::size_t width) {
  std::string bytes;
  for (std::size_t row = 0; row < pixels.size(); row += width)
    for_runs(
        width, [&](std::size_t a, std::size_t b) { return pixels[row + a] == pixels[row + b]; },
        [&](std::size_t x, std::size_t count) {
          bytes += flat_rows({pixels[row + x]});
          for (std::size_t more = count - 1; more > 0; more /= 256)
            bytes += std::string("\1\1\1") + static_cast<char>(more % 256);
        });
  return bytes;
}

std::string coded_rows(const SharedExponents& pixels, std::size_t width) {
  std::string bytes;
  for (std::size_t row = 0; row < pixels.size(); row += width) {
    bytes += std::string("\2\2") + static_cast<char>(width / 256) + static_cast<char>(width % 256);
    for (std::size_t c = 0; c < 4; ++c)
      for_runs(
          width, [&](std::size_t a, std::size_t b) { return pixels[row + a][c] == pixels[row + b][c]; },
          [&](std::size_t x, std::size_t count) {
            for (std::size_t done = 0, some = 0; done < count; done += some) {
              some = std::min<std::size_t>(count - done, 127);
              bytes += static_cast<char>(some == 1 ? 1 : 128 + some);  // one byte as it is, or a run
              bytes += static_cast<char>(pixels[row + x][c]);
            }
          });
  }
  return bytes;
}

std::vector<Vec3f> colors_of(const SharedExponents& pixels) {
  std::vector<Vec3f> colors;
  for (const SharedExponent& p : pixels)
    colors.push_back(p[3] == 0 ? Vec3f(0, 0, 0) : Vec3f(Vec3f(p[0], p[1], p[2]) * std::ldexp(1.0f, p[3] - 136)));
  return colors;
}

void expect_refused(const std::string& bytes, const std::string& reason, const std::string& what) {
  try {
    decode_radiance("a.hdr", bytes);
    ADD_FAILURE() << "accepted: " << what;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    EXPECT_TRUE(message.starts_with("a.hdr: cannot be read: ")) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << what << ": " << message;
    EXPECT_NE(message.find("Accepted: "), std::string::npos) << message;
  }
}

TEST(Radiance, ThreeCodingsOfAPictureAreThePicture) {
  constexpr int kHeight = 3;
  for (const int width : {1, 7, 8, 9, 300, 32767, 40000}) {
    const SharedExponents pixels = some_exponents(width, kHeight);
    const auto across = static_cast<std::size_t>(width);
    std::vector<std::string> codings{flat_rows(pixels), rows_with_runs(pixels, across)};
    if (width >= 8 && width < 32768) codings.push_back(coded_rows(pixels, across));
    for (const std::string& rows : codings) {
      const EnvironmentImage image = decode_radiance("a.hdr", radiance_header(width, kHeight) + rows);
      EXPECT_EQ(image.width, width);
      EXPECT_EQ(image.height, kHeight);
      EXPECT_TRUE(image.pixels == colors_of(pixels)) << width << ", " << rows.size() << " bytes";
    }
  }
}

TEST(Radiance, EachRowTellsItsCoding) {
  const SharedExponents pixels = some_exponents(9, 1);
  const std::string rows = rows_with_runs(pixels, 9) + coded_rows(pixels, 9) + flat_rows(pixels);
  const EnvironmentImage image = decode_radiance("a.hdr", radiance_header(9, 3) + rows);
  SharedExponents all;
  for (int row = 0; row < 3; ++row) all.insert(all.end(), pixels.begin(), pixels.end());
  EXPECT_TRUE(image.pixels == colors_of(all));
}

TEST(Radiance, RefusesEveryFileThatIsCutOff) {
  const SharedExponents pixels = some_exponents(9, 2);
  for (const std::string& rows : {flat_rows(pixels), rows_with_runs(pixels, 9), coded_rows(pixels, 9)}) {
    const std::string whole = radiance_header(9, 2) + rows;
    for (std::size_t length = 0; length < whole.size(); ++length)
      expect_refused(whole.substr(0, length), "it ", fmt::format("{} of {} bytes", length, whole.size()));
    EXPECT_NO_THROW(decode_radiance("a.hdr", whole));
  }
}

TEST(Radiance, RefusesRowsThatDoNotFit) {
  using namespace std::string_literals;
  const std::string header = radiance_header(9, 1), row = "\2\2\0\11"s, more(100, '\7');
  expect_refused(header + row + "\0"s + more, "a run has no pixels", "no bytes");
  expect_refused(header + row + "\212\1"s + more, "beyond the end of its row", "a run of 10");
  expect_refused(header + row + "\12"s + more, "beyond the end of its row", "10 bytes");
  expect_refused(header + row + "\210\1\2"s + more, "beyond the end of its row", "a run of 8, then 2 bytes");
  expect_refused(header + "\2\2\0\10"s + more, "another number of pixels", "a row of 8");
  expect_refused(header + "\1\1\1\3"s + more, "begins with a run", "a run of nothing");
  expect_refused(header + "\200\1\1\201\1\1\1\11"s + more, "beyond the end of its row", "a pixel and 9 more");
  expect_refused(header + "\200\1\1\201\1\1\1\0\1\1\1\1"s + more, "beyond the end of its row", "a pixel and 256 more");
}

TEST(Radiance, RefusesSizesThatNoPictureHas) {
  const std::string pixels(64, '\200');
  EXPECT_NO_THROW(decode_radiance("a.hdr", radiance_header("-Y 4 +X 4") + pixels));
  for (const char* size : {"-Y 0 +X 4", "-Y 4 +X 0", "-Y -4 +X 4", "-Y 4 +X -4", "-Y 65537 +X 1", "-Y 99999999999 +X 1",
                           "-Y 4", "-Y +X", "", "4 4", "-Y 4 +X 4 4"})
    expect_refused(radiance_header(size) + pixels, "its size ", size);
  expect_refused(radiance_header("-Y 65536 +X 65536") + pixels, "it claims to have 65536 x 65536 pixels", "too many");
  for (const char* turned : {"+Y 4 +X 4", "-Y 4 -X 4", "+Y 4 -X 4", "+X 4 -Y 4"})
    expect_refused(radiance_header(turned) + pixels, "its size is not written as '-Y height", turned);
}

TEST(Radiance, RefusesWhatIsNoRgbePicture) {
  const std::string size = "-Y 4 +X 4", pixels(64, '\200');
  expect_refused(radiance_header(size, "FORMAT=32-bit_rle_xyze\n") + pixels, "its colours are XYZ", "XYZE");
  expect_refused(radiance_header(size, "") + pixels, "FORMAT=32-bit_rle_rgbe", "no format");
  expect_refused("\x89PNG\r\n\x1a\n" + pixels, "does not begin as", "a PNG");
  EXPECT_NO_THROW(decode_radiance("a.hdr", "#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n" + pixels));
}

TEST(Radiance, TexturesAndEnvironmentsReadItAndNameTheFileThatIsCutOff) {
  const SharedExponents pixels = some_exponents(9, 2);
  const std::string path = testing::test_folder() / "picture.hdr";
  const std::string whole = radiance_header(9, 2) + coded_rows(pixels, 9);
  std::ofstream(path, std::ios::binary) << whole;
  EXPECT_TRUE(read_environment(path).pixels == colors_of(pixels));
  EXPECT_TRUE(read_texture_picture(path).pixels == colors_of(pixels));
  std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() - 1);
  for (const bool is_there : {true, false}) {
    try {
      read_environment(path);
      FAIL() << is_there;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      EXPECT_TRUE(std::string(error.what()).starts_with(path + ": cannot be read: it ")) << error.what();
    }
    std::filesystem::remove(path);
  }
}

}  // namespace
}  // namespace softreel
