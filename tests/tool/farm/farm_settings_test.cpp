#include "tool/farm/farm_settings.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace softreel {
namespace {

TEST(FarmSettings, ReadsTimeLimitsInSlurmsForms) {
  EXPECT_EQ(parse_time("90"), 5400);
  EXPECT_EQ(parse_time("1:30"), 90);
  EXPECT_EQ(parse_time("2:00:05"), 7205);
  EXPECT_EQ(parse_time("1-6"), 30 * 3600);
  EXPECT_EQ(parse_time("1-6:30"), 30 * 3600 + 1800);
  EXPECT_EQ(parse_time("0-0:0:9"), 9);
}

TEST(FarmSettings, RefusesWhatIsNoTimeLimit) {
  for (const char* text : {"", "0", "x", "-5", "1:2:3:4", "1h", "1-", "1::2", " 5", "0:00", "99999999999999999999"})
    EXPECT_THROW(parse_time(text), Error) << text;
}

TEST(FarmSettings, ReadsMemoryAsSlurmDoes) {
  EXPECT_EQ(parse_memory("500"), 500 * 1048576.0);
  EXPECT_EQ(parse_memory("500M"), 500 * 1048576.0);
  EXPECT_EQ(parse_memory("12G"), 12 * 1073741824.0);
  EXPECT_EQ(parse_memory("3K"), 3072);
  for (const char* text : {"", "G", "0", "-1G", "1.5G", "12GB", "1 G"}) EXPECT_THROW(parse_memory(text), Error) << text;
}

TEST(FarmSettings, MessagesNameOptionValueAndWhatIsAccepted) {
  try {
    parse_time("soon");
    FAIL();
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    for (const char* part : {"--time", "\"soon\"", "Accepted: ", "MINUTES"})
      EXPECT_NE(message.find(part), std::string::npos) << part;
  }
}

TEST(FarmSettings, WhatIsGivenWinsOverTheEstimate) {
  const FarmJob job{FarmStep::Frames, 0, {{1, 4}, {5, 6}}, {}};
  const FarmEstimate estimate{4e9, 10, 100, 50};
  FarmSettings settings;
  const FarmNeeds guessed = needs_of(job, estimate, settings);
  EXPECT_GE(guessed.bytes, 2 * estimate.bytes) << "an estimate is right within a factor of two";
  EXPECT_GE(guessed.seconds, 2 * 4 * estimate.frame_seconds) << "of the longest task";
  settings.memory = "3G";
  settings.time = "5";
  settings.cpus = 7;
  const FarmNeeds given = needs_of(job, estimate, settings);
  EXPECT_EQ(given.bytes, 3 * 1073741824.0);
  EXPECT_EQ(given.seconds, 300);
  EXPECT_EQ(given.cpus, 7);
}

TEST(FarmSettings, EveryTaskHasALimitEvenIfTheEstimateIsNothing) {
  for (const FarmStep step : {FarmStep::Simulate, FarmStep::Frames, FarmStep::Movie}) {
    const FarmNeeds needs = needs_of({step, 0, {{1, 1}}, {}}, {}, {});
    EXPECT_GT(needs.seconds, 0);
    EXPECT_GT(needs.bytes, 0);
    EXPECT_GE(needs.cpus, 1);
  }
}

TEST(FarmSettings, ChunksGiveSeveralNodesWorkAndStayWithinFiveMinutes) {
  EXPECT_EQ(default_chunk({0, 0, 0, 1}, 96), 12) << "eight tasks, though each is short";
  EXPECT_EQ(default_chunk({0, 0, 0, 60}, 960), 5);
  EXPECT_EQ(default_chunk({0, 0, 0, 3600}, 96), 1);
  EXPECT_EQ(default_chunk({0, 0, 0, 0}, 3), 1);
  EXPECT_GE(default_chunk({}, 0), 1);
}

TEST(FarmSettings, ARetryKeepsWhatIsNotGivenAnew) {
  FarmSettings before, given;
  before.partition = "gpu";
  before.memory = "4G";
  before.chunk = 3;
  before.sbatch = {"--nice=5"};
  given.memory = "8G";
  const FarmSettings merged_settings = merged(before, given);
  EXPECT_EQ(merged_settings.partition, "gpu");
  EXPECT_EQ(merged_settings.memory, "8G");
  EXPECT_EQ(merged_settings.chunk, 3);
  EXPECT_EQ(merged_settings.sbatch, before.sbatch);
}

}  // namespace
}  // namespace softreel
