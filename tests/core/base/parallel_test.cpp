#include "core/base/parallel.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(Threads, EveryIndexIsVisitedOnce) {
  const Threads threads(4);
  std::vector<std::atomic<int>> visits(1001);
  threads.for_chunks(1001, 7, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
  });
  for (const auto& count : visits) EXPECT_EQ(count.load(), 1);
}

TEST(Threads, SumsHaveTheSameBitsAtAnyThreadCount) {
  const auto sum = [](int count) {
    return Threads(count).sum_chunks(100000, 64, [](std::int64_t begin, std::int64_t end) {
      double s = 0;
      for (std::int64_t i = begin; i < end; ++i) s += std::sin(static_cast<double>(i)) * 1e-3;
      return s;
    });
  };
  const double one = sum(1);
  EXPECT_EQ(one, sum(2));
  EXPECT_EQ(one, sum(4));
}

TEST(Threads, ThrowsTheFailureOfTheFirstChunk) {
  const Threads threads(4);
  try {
    threads.for_chunks(100, 1, [](std::int64_t begin, std::int64_t) {
      if (begin == 20 || begin == 70) throw std::runtime_error(std::to_string(begin));
    });
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "20");
  }
}

TEST(Threads, NothingRunsForAnEmptyRange) {
  Threads(2).for_chunks(0, 10, [](std::int64_t, std::int64_t) { FAIL(); });
  EXPECT_EQ(Threads(2).sum_chunks(0, 10, [](std::int64_t, std::int64_t) { return 1.0; }), 0.0);
}

TEST(Threads, ManyShortLoopsVisitEveryIndexOnceAtAnyPace) {
  const Threads threads(3);
  std::vector<int> visits(300);
  for (int loop = 0; loop < 5000; ++loop) {
    // Now and then long enough for the helpers to fall asleep.
    if (loop % 1000 == 999) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    threads.for_chunks(300, 20, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
    });
  }
  for (const int count : visits) EXPECT_EQ(count, 5000);
}

TEST(Threads, LoopsOfSeveralThreadsRunBesideEachOther) {
  const Threads threads(2);
  std::vector<double> sums(4);
  std::vector<std::thread> callers;
  for (double& sum : sums)
    callers.emplace_back([&] {
      for (int loop = 0; loop < 300; ++loop)
        sum += threads.sum_chunks(1000, 50, [](std::int64_t begin, std::int64_t end) {
          double s = 0;
          for (std::int64_t i = begin; i < end; ++i) s += static_cast<double>(i);
          return s;
        });
    });
  for (std::thread& caller : callers) caller.join();
  for (const double sum : sums) EXPECT_EQ(sum, 300 * 499'500.0);
}

TEST(Threads, ALoopWithinALoopRuns) {
  const Threads threads(2);
  std::vector<std::atomic<int>> visits(60);
  threads.for_chunks(6, 1, [&](std::int64_t outer, std::int64_t) {
    threads.for_chunks(
        10, 1, [&](std::int64_t inner, std::int64_t) { ++visits[static_cast<std::size_t>(10 * outer + inner)]; });
  });
  for (const auto& count : visits) EXPECT_EQ(count.load(), 1);
}

}  // namespace
}  // namespace softreel
