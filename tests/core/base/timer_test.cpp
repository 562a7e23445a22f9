#include "core/base/timer.h"

#include <thread>

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(ScopedStage, AddsItsTimeAndCountsItsCalls) {
  StageTimes times;
  for (int i = 0; i < 3; ++i) {
    const ScopedStage stage(times, "simulate/solve");
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  const auto entries = times.entries();
  ASSERT_EQ(entries.count("simulate/solve"), 1U);
  EXPECT_EQ(entries.at("simulate/solve").calls, 3);
  EXPECT_GE(entries.at("simulate/solve").seconds, 0.006);
}

}  // namespace
}  // namespace softreel
