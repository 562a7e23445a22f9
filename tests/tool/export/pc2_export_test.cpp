#include "tool/export/pc2_export.h"

#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace softreel {
namespace {

/// Bytes of a cache of two points and the samples given.
std::vector<std::uint8_t> write_cache(const Pc2Params& params, const std::vector<std::vector<Vec3>>& samples) {
  std::vector<std::uint8_t> bytes;
  Pc2Writer writer(params,
                   [&](std::span<const std::uint8_t> part) { bytes.insert(bytes.end(), part.begin(), part.end()); });
  for (const std::vector<Vec3>& sample : samples) writer.append(sample);
  writer.finish();
  return bytes;
}

template <typename T>
T value_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(Pc2Writer, WritesTheHeaderThenTheNearestFloatOfEveryCoordinate) {
  const std::vector<std::vector<Vec3>> samples{{{0.1, -0.2, 1e-3}, {1, 2, 3}}, {{1.0 / 3, 0, -0.0}, {16777217, 5, 6}}};
  const std::vector<std::uint8_t> bytes =
      write_cache({.points = 2, .samples = 2, .start_frame = 12, .frames_apart = 0.5}, samples);
  ASSERT_EQ(bytes.size(), 32U + 2 * 2 * 12);
  EXPECT_EQ(std::memcmp(bytes.data(), "POINTCACHE2\0", 12), 0);
  EXPECT_EQ(value_at<std::int32_t>(bytes, 12), 1);
  EXPECT_EQ(value_at<std::int32_t>(bytes, 16), 2);
  EXPECT_EQ(value_at<float>(bytes, 20), 12.0F);
  EXPECT_EQ(value_at<float>(bytes, 24), 0.5F);
  EXPECT_EQ(value_at<std::int32_t>(bytes, 28), 2);
  std::size_t at = 32;
  for (const std::vector<Vec3>& sample : samples)
    for (const Vec3& p : sample)
      for (int k = 0; k < 3; ++k, at += 4) EXPECT_EQ(value_at<float>(bytes, at), static_cast<float>(p[k]));
}

TEST(Pc2Writer, PassesOnEachFrameWhenItComes) {
  std::vector<std::size_t> parts;
  Pc2Writer writer({.points = 1, .samples = 2},
                   [&](std::span<const std::uint8_t> part) { parts.push_back(part.size()); });
  EXPECT_EQ(parts, std::vector<std::size_t>({32}));
  writer.append(std::vector<Vec3>{Vec3::Zero()});
  EXPECT_EQ(parts, std::vector<std::size_t>({32, 12}));
}

TEST(Pc2Writer, RefusesWhatReadersWouldShowAsGarbage) {
  EXPECT_THROW(write_cache({.points = 0, .samples = 1}, {{}}), Error);
  EXPECT_THROW(write_cache({.points = 1, .samples = 0}, {}), Error);
  EXPECT_THROW(write_cache({.points = 1, .samples = 2}, {{Vec3::Zero()}}), Error);
  for (const double bad : {1e39, std::numeric_limits<double>::quiet_NaN()}) {
    try {
      write_cache({.points = 2, .samples = 1}, {{Vec3::Zero(), Vec3(0, bad, 0)}});
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Work);
      EXPECT_NE(std::string(error.what()).find("sample 1: vertex 2"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace softreel
