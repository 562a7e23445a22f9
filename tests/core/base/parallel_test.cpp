#include "core/base/parallel.h"

#include <atomic>
#include <cmath>
#include <stdexcept>
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

}  // namespace
}  // namespace softreel
