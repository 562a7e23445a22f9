#include "core/mesh/readers/point_cache_reader.h"

#include <algorithm>
#include <cstring>

#include "tests/core/mesh/mesh_files.h"

namespace softreel {
namespace {

using testing::TemporaryFolder;

template <typename T>
void put(std::string& bytes, T value, bool big_endian = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big_endian) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// Two points that rise by 1 a sample.
void put_positions(std::string& bytes, int samples, bool big_endian) {
  for (int s = 0; s < samples; ++s)
    for (const float x : {0.0f, 5.0f})
      for (const float number : {x, static_cast<float>(s), 0.0f}) put(bytes, number, big_endian);
}

std::string pc2(float rate, int samples) {
  std::string bytes("POINTCACHE2\0", 12);
  for (const int number : {1, 2}) put(bytes, number);
  put(bytes, 7.0f);
  put(bytes, rate);
  put(bytes, samples);
  put_positions(bytes, samples, false);
  return bytes;
}

std::string mdd(const std::vector<float>& times) {
  std::string bytes;
  put(bytes, static_cast<int>(times.size()), true);
  put(bytes, 2, true);
  for (const float time : times) put(bytes, time, true);
  put_positions(bytes, static_cast<int>(times.size()), true);
  return bytes;
}

std::string refusal(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  try {
    read_point_cache(folder.write(name, bytes), 24);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    return error.what();
  }
  return "";
}

TEST(PointCacheReader, ReadsBothFormatsAtTheirTimes) {
  const TemporaryFolder folder;
  const CachedVertices half_frames(read_point_cache(folder.write("a.pc2", pc2(0.5f, 3)), 24));
  const CachedVertices at_times(read_point_cache(folder.write("a.mdd", mdd({2, 2.5f, 4})), 24));
  EXPECT_EQ(half_frames.count(), 2);
  EXPECT_EQ(at_times.count(), 2);
  const std::vector<Index> second{1};
  EXPECT_EQ(half_frames.at(0.5 / 24, second)[0], Vec3(5, 1, 0));
  EXPECT_DOUBLE_EQ(half_frames.at(0.25 / 24, second)[0].y(), 0.5);
  EXPECT_EQ(at_times.at(0.5, second)[0], Vec3(5, 1, 0)) << "its first time is 0";
  EXPECT_DOUBLE_EQ(at_times.at(1.25, second)[0].y(), 1.5);
  for (const CachedVertices* cache : {&half_frames, &at_times}) {
    EXPECT_EQ(cache->at(-1, second)[0], Vec3(5, 0, 0));
    EXPECT_EQ(cache->at(99, second)[0], Vec3(5, 2, 0));
    EXPECT_EQ(cache->pose(99), cache->pose(100));
    EXPECT_NE(cache->pose(0), cache->pose(99));
  }
}

TEST(PointCacheReader, RefusesWhatIsBroken) {
  const std::string good = pc2(1, 3), timed = mdd({0, 1, 2});
  EXPECT_NE(refusal("a.pc2", good.substr(0, good.size() - 4)).find("ends before"), std::string::npos);
  EXPECT_NE(refusal("a.mdd", timed.substr(0, timed.size() - 4)).find("ends before"), std::string::npos);
  EXPECT_NE(refusal("a.pc2", "POINTCACHE").find("POINTCACHE2"), std::string::npos);
  EXPECT_NE(refusal("a.pc2", pc2(0, 3)).find("apart"), std::string::npos);
  EXPECT_NE(refusal("a.mdd", mdd({0, 2, 1})).find("sample 2"), std::string::npos);
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN(), kFar = std::numeric_limits<float>::infinity();
  EXPECT_NE(refusal("a.mdd", mdd({kNone})).find("sample 0 is not finite"), std::string::npos);
  EXPECT_NE(refusal("a.mdd", mdd({0, 1, kFar})).find("sample 2 is not finite"), std::string::npos);
  EXPECT_NE(refusal("a.pc2", pc2(1, 0)).find("0 samples"), std::string::npos);
  std::string huge = good;
  const std::int32_t many = 2000000000;
  std::memcpy(huge.data() + 28, &many, 4);
  EXPECT_NE(refusal("a.pc2", huge).find("do not fit"), std::string::npos) << "before anything is allocated";
}

}  // namespace
}  // namespace softreel
