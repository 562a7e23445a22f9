#include "core/base/thread_team.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace softreel {
namespace {

using std::chrono::milliseconds;

/// Waits until `count` is `wanted`; false if it is not after ten seconds, so that a helper that never comes is a
/// failure.
bool comes_to(const std::atomic<int>& count, int wanted) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (count != wanted) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return true;
}

/// Whether a job gets `threads` threads at once: each is kept in it until all are there.
bool brings_together(ThreadTeam& team, int threads) {
  std::atomic<int> inside{0}, met{0};
  const bool ran = team.run(threads, [&](std::int64_t) {
    ++inside;
    if (comes_to(inside, threads)) ++met;
  });
  return ran && met == threads;
}

TEST(ThreadTeam, RunsEveryIndexOnce) {
  ThreadTeam team(3);
  for (const std::int64_t n : {0, 1, 2, 1000}) {
    std::vector<std::atomic<int>> visits(static_cast<std::size_t>(n));
    EXPECT_TRUE(team.run(n, [&](std::int64_t k) { ++visits[static_cast<std::size_t>(k)]; }));
    for (const auto& count : visits) EXPECT_EQ(count, 1) << n;
  }
}

TEST(ThreadTeam, WhatHelpersWroteIsThereWhenRunReturns) {
  ThreadTeam team(2);
  std::vector<int> plain(64);
  for (int job = 0; job < 2000; ++job)
    ASSERT_TRUE(team.run(64, [&](std::int64_t k) { ++plain[static_cast<std::size_t>(k)]; }));
  for (const int count : plain) EXPECT_EQ(count, 2000);
}

TEST(ThreadTeam, RefusesAnotherThreadWhileItIsAtWork) {
  ThreadTeam team(1);
  std::atomic<int> stage{0}, wrong{0};
  std::thread owner([&] {
    team.run(1, [&](std::int64_t) {
      stage = 1;
      comes_to(stage, 2);
    });
  });
  EXPECT_TRUE(comes_to(stage, 1));
  EXPECT_FALSE(team.run(5, [&](std::int64_t) { ++wrong; }));
  stage = 2;
  owner.join();
  EXPECT_EQ(wrong, 0) << "a refused loop runs nothing";
  EXPECT_TRUE(brings_together(team, 2)) << "it is free again";
}

TEST(ThreadTeam, RefusesALoopWithinItsLoop) {
  ThreadTeam team(2);
  std::atomic<int> outer{0}, wrong{0};
  EXPECT_TRUE(team.run(20, [&](std::int64_t) {
    ++outer;
    if (team.run(3, [&](std::int64_t) { ++wrong; })) ++wrong;
  }));
  EXPECT_EQ(outer, 20);
  EXPECT_EQ(wrong, 0);
}

TEST(ThreadTeam, SleepingHelpersWakeForTheNextJob) {
  ThreadTeam team(2);
  for (const int pause_ms : {0, 1, 20, 0, 20}) {
    std::this_thread::sleep_for(milliseconds(pause_ms));  // helpers sleep after 40 us
    EXPECT_TRUE(brings_together(team, 3)) << pause_ms;
  }
}

TEST(ThreadTeam, EndsBeforeAnyJobAfterOneAndAsleep) {
  { const ThreadTeam never_run(2); }
  for (const int pause_ms : {0, 20}) {
    auto team = std::make_unique<ThreadTeam>(2);
    EXPECT_TRUE(brings_together(*team, 3));
    std::this_thread::sleep_for(milliseconds(pause_ms));
    team.reset();  // joins its helpers: a lost wake-up would hang here
  }
  for (int k = 0; k < 200; ++k) {
    ThreadTeam team(2);
    EXPECT_TRUE(team.run(1, [](std::int64_t) {}));  // its helpers may not have begun
  }
}

}  // namespace
}  // namespace softreel
