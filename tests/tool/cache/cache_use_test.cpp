#include "tool/cache/cache_use.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tool/cache/atomic_file.h"

namespace softreel {
namespace {
namespace fs = std::filesystem;

class CacheUseTest : public ::testing::Test {
 protected:
  CacheUseTest()
      : folder_((fs::temp_directory_path() / fmt::format("softreel_use_{}", ::getpid())).string()),
        cache_((fs::remove_all(folder_), folder_), Cache::Storing::Required, log_) {}
  ~CacheUseTest() override { fs::remove_all(folder_); }

  /// Ten results of 1000 bytes, "0" used longest ago.
  void store_ten() {
    for (int i = 0; i < 10; ++i) {
      cache_.store("simulation", std::to_string(i), Bytes(1000), 0);
      fs::last_write_time(cache_.path("simulation", std::to_string(i)),
                          fs::file_time_type::clock::now() - std::chrono::hours(100 - i));
    }
  }
  bool has(int i) const { return cache_.has("simulation", std::to_string(i)); }

  std::string folder_;
  const Log log_;
  Cache cache_;
};

TEST_F(CacheUseTest, CuttingRemovesWhatWasUsedLongestAgo) {
  store_ten();
  EXPECT_TRUE(cache_.load("simulation", "0").has_value());  // used now
  cut_cache(cache_, 0.45 * cache_size(cache_));
  EXPECT_TRUE(has(0));
  for (int i = 1; i <= 6; ++i) EXPECT_FALSE(has(i)) << i;
  for (int i = 7; i <= 9; ++i) EXPECT_TRUE(has(i)) << i;
}

TEST_F(CacheUseTest, WhatARunningJobClaimsStaysWhateverTheLimit) {
  store_ten();
  {
    CacheUse use(cache_, "shot.toml", "out");
    use.claim({"simulation/2", "simulation/3"});
    use.release("simulation/3");
    cut_cache(cache_, 0);
    EXPECT_TRUE(has(2));
    EXPECT_FALSE(has(3)) << "the job is done with it";
    EXPECT_FALSE(has(9));
    empty_cache(cache_, false);
    EXPECT_TRUE(has(2));
  }
  cut_cache(cache_, 0);
  EXPECT_FALSE(has(2)) << "the job has ended";
}

TEST_F(CacheUseTest, WhatIsBeingWrittenStaysWhateverTheLimit) {
  AtomicFile growing(cache_.path("simulation", "new"), AtomicFile::Writer::Others);
  growing.write(Bytes(100));
  cut_cache(cache_, 0);
  empty_cache(cache_, false);
  clean_cache(cache_, "owner", {}, false);
  EXPECT_NO_THROW(growing.commit());
  EXPECT_TRUE(cache_.has("simulation", "new"));
}

TEST_F(CacheUseTest, TwoJobsOfOneNameAndNumberDoNotWaitForEachOther) {
  store_ten();
  std::optional<CacheUse> first, second;
  first.emplace(cache_, "shot.toml", "out");  // as two containers have them that share the host's name
  first->claim({"simulation/1"});
  auto made = std::async(std::launch::async, [&] { second.emplace(cache_, "shot.toml", "out"); });
  if (made.wait_for(std::chrono::seconds(20)) != std::future_status::ready) {
    first.reset();  // or the second waits for ever
    FAIL() << "the second waits for the first";
  }
  second->claim({"simulation/2"});
  cut_cache(cache_, 0);
  EXPECT_TRUE(has(1));
  EXPECT_TRUE(has(2));
  second.reset();
  cut_cache(cache_, 0);
  EXPECT_TRUE(has(1)) << "the first goes on";
  EXPECT_FALSE(has(2));
}

TEST_F(CacheUseTest, ADryRunCountsTheSameAndRemovesNothing) {
  store_ten();
  const CacheRemoval dry = cut_cache(cache_, 3000, true);
  EXPECT_TRUE(has(0));
  const CacheRemoval removal = cut_cache(cache_, 3000);
  EXPECT_EQ(dry.files, removal.files);
  EXPECT_EQ(dry.bytes, removal.bytes);
  EXPECT_LE(cache_size(cache_), 3000);
}

TEST_F(CacheUseTest, ClocksThatJumpChangeTheOrderOnly) {
  store_ten();
  fs::last_write_time(cache_.path("simulation", "5"), fs::file_time_type::clock::now() + std::chrono::hours(1000000));
  CacheUse use(cache_, "shot.toml", "out");
  use.claim({"simulation/0"});
  cut_cache(cache_, 2500);
  EXPECT_TRUE(has(0));
  EXPECT_TRUE(has(5));
}

TEST_F(CacheUseTest, CleaningKeepsTheNeedsOfOtherShotsThatExist) {
  store_ten();
  const std::string other = folder_ + "/other.toml";
  { std::ofstream(other) << "x"; }
  {
    CacheUse use(cache_, other, "out");
    use.claim({"simulation/1"});
  }
  {
    CacheUse use(cache_, folder_ + "/gone.toml", "out");
    use.claim({"simulation/2"});
  }
  clean_cache(cache_, CacheUse::owner_id("shot.toml", "out"), {"simulation/3"}, false);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(has(i), i == 1 || i == 3) << i;
}

TEST_F(CacheUseTest, ANewRunOfAShotReplacesWhatItNeededBefore) {
  store_ten();
  const std::string shot = folder_ + "/shot.toml";
  { std::ofstream(shot) << "x"; }
  for (const char* item : {"simulation/4", "simulation/5"}) {
    CacheUse use(cache_, shot, "out");
    use.claim({item});
  }
  clean_cache(cache_, "another owner", {}, false);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(has(i), i == 5) << i;
}

}  // namespace
}  // namespace softreel
