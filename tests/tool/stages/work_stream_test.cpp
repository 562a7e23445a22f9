#include "tool/stages/work_stream.h"

#include <atomic>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(AheadStream, GivesItemsInOrderAndNeverRunsFurtherAheadThanItsDepth) {
  for (const std::size_t depth : {0U, 1U, 3U}) {
    std::atomic<int> made{0};
    AheadStream<int> stream(depth, [&]() -> std::optional<int> {
      if (made == 50) return std::nullopt;
      return made++;
    });
    for (int taken = 0; taken < 50; ++taken) {
      EXPECT_EQ(stream.next(), taken);
      // Those in the queue, and the one that waits for a place in it.
      EXPECT_LE(made, taken + 1 + static_cast<int>(depth) + 1);
    }
    EXPECT_FALSE(stream.next().has_value());
  }
}

TEST(AheadStream, ThrowsAnErrorInThePlaceOfTheItem) {
  for (const std::size_t depth : {0U, 2U}) {
    int made = 0;
    AheadStream<int> stream(depth, [&]() -> std::optional<int> {
      if (made == 3) throw std::runtime_error("the fourth");
      return made++;
    });
    for (int taken = 0; taken < 3; ++taken) EXPECT_EQ(stream.next(), taken);
    EXPECT_THROW(stream.next(), std::runtime_error);
  }
}

TEST(AheadStream, EndsWhenItsOwnerLeaves) {
  int made = 0;
  {
    AheadStream<int> stream(2, [&]() -> std::optional<int> { return made++; });
  }
  EXPECT_LE(made, 4);
}

TEST(BehindStream, DoesJobsInOrderAndFinishWaitsForAll) {
  for (const std::size_t depth : {0U, 1U, 2U}) {
    std::vector<int> done;
    BehindStream stream(depth);
    for (int i = 0; i < 50; ++i) stream.submit([&done, i] { done.push_back(i); });
    stream.finish();
    ASSERT_EQ(done.size(), 50U);
    for (int i = 0; i < 50; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
  }
}

TEST(BehindStream, AFailedJobIsThrownAndNoneAfterItIsDone) {
  for (const std::size_t depth : {0U, 2U}) {
    int done = 0;
    BehindStream stream(depth);
    const auto work = [&] {
      for (int i = 0; i < 10; ++i)
        stream.submit([&done, i] {
          if (i == 2) throw std::runtime_error("the third");
          ++done;
        });
      stream.finish();
    };
    EXPECT_THROW(work(), std::runtime_error);
    EXPECT_EQ(done, 2);
  }
}

TEST(BehindStream, DoesWhatWasSubmittedBeforeItEnds) {
  std::atomic<int> done{0};
  {
    BehindStream stream(5);
    for (int i = 0; i < 4; ++i) stream.submit([&] { ++done; });
  }
  EXPECT_EQ(done, 4);
}

}  // namespace
}  // namespace softreel
