#include "tool/batch/schedule.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace softreel {
namespace {

/// Plays a batch through: `end_one` chooses which of the running jobs ends next. Checks the limits at every moment.
class Played {
 public:
  Played(const ScheduleLimits& limits, std::vector<double> bytes, std::uint64_t seed)
      : limits_(limits), bytes_(bytes), schedule_(limits, std::move(bytes)), random_(seed) {}

  void run() {
    while (schedule_.waiting() > 0 || !running_.empty()) {
      while (const auto job = schedule_.start_next()) {
        started_.push_back(*job);
        running_.push_back(*job);
        check_limits();
      }
      check_that_the_first_does_not_fit();
      ASSERT_FALSE(running_.empty()) << "nothing runs although " << schedule_.waiting() << " wait";
      const auto which = std::uniform_int_distribution<std::size_t>(0, running_.size() - 1)(random_);
      schedule_.end(running_[which]);
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(which));
    }
  }

  const std::vector<std::size_t>& started() const { return started_; }

 private:
  double running_bytes() const {
    double sum = 0;
    for (const std::size_t job : running_) sum += bytes_[job];
    return sum;
  }

  void check_limits() const {
    EXPECT_LE(static_cast<int>(running_.size()), limits_.jobs);
    if (running_.size() > 1) {
      EXPECT_LE(running_bytes(), limits_.bytes);
    }
    EXPECT_EQ(schedule_.running(), static_cast<int>(running_.size()));
  }

  /// What ended is given back to the last byte, or jobs that fit would wait.
  void check_that_the_first_does_not_fit() const {
    std::size_t first = 0;
    while (std::find(started_.begin(), started_.end(), first) != started_.end()) ++first;
    if (first == bytes_.size() || static_cast<int>(running_.size()) == limits_.jobs) return;
    EXPECT_GT(running_bytes() + bytes_[first], limits_.bytes * (1 - 1e-9));
  }

  ScheduleLimits limits_;
  std::vector<double> bytes_;
  Schedule schedule_;
  std::mt19937_64 random_;
  std::vector<std::size_t> running_, started_;
};

/// How many later jobs started before each.
std::vector<int> passed(const std::vector<std::size_t>& started) {
  std::vector<int> counts(started.size(), 0);
  for (std::size_t late = 0; late < started.size(); ++late)
    for (std::size_t early = 0; early < late; ++early)
      if (started[early] > started[late]) counts[started[late]] += 1;
  return counts;
}

TEST(Schedule, KeepsItsLimitsAndStartsEveryJobOnceWhateverEndsWhen) {
  std::mt19937_64 random(8);
  for (int trial = 0; trial < 300; ++trial) {
    const int jobs = std::uniform_int_distribution(1, 6)(random);
    std::vector<double> bytes(std::uniform_int_distribution<std::size_t>(1, 40)(random));
    for (double& one : bytes) one = std::pow(10, std::uniform_real_distribution(-1.0, 1.3)(random));
    Played played({jobs, 10}, bytes, random());
    ASSERT_NO_FATAL_FAILURE(played.run());
    std::vector<std::size_t> sorted = played.started();
    std::sort(sorted.begin(), sorted.end());
    ASSERT_EQ(sorted.size(), bytes.size());
    for (std::size_t job = 0; job < sorted.size(); ++job) ASSERT_EQ(sorted[job], job);
    for (const int count : passed(played.started())) EXPECT_LE(count, jobs) << "a job is passed by more than may";
  }
}

TEST(Schedule, JobsThatAllFitStartInTheirOrder) {
  Played played({3, 100}, std::vector<double>(12, 1.0), 1);
  played.run();
  EXPECT_TRUE(std::is_sorted(played.started().begin(), played.started().end()));
}

TEST(Schedule, AJobThatNeedsMoreThanAllRunsAlone) {
  Schedule schedule({4, 10}, {1, 50, 1, 1, 1, 1, 1, 1, 1});
  EXPECT_TRUE(schedule.needs_more_than_all(1));
  EXPECT_FALSE(schedule.needs_more_than_all(0));
  std::vector<std::size_t> running;
  while (const auto job = schedule.start_next()) running.push_back(*job);
  EXPECT_EQ(running, (std::vector<std::size_t>{0, 2, 3, 4}));
  for (const std::size_t job : running) schedule.end(job);
  // Three passed it; one more may.
  std::vector<std::size_t> next;
  while (const auto job = schedule.start_next()) next.push_back(*job);
  EXPECT_EQ(next, (std::vector<std::size_t>{1})) << "it starts as soon as nothing runs, and nothing beside it";
}

TEST(Schedule, SmallJobsDoNotKeepALargeOneWaitingForEver) {
  std::vector<double> bytes(1000, 3.0);
  bytes[1] = 9;
  Schedule schedule({3, 10}, bytes);
  std::vector<std::size_t> running;
  std::size_t starts = 0;
  bool large_ran = false;
  while (!large_ran && starts < 100) {
    while (const auto job = schedule.start_next()) {
      running.push_back(*job);
      starts += 1;
      large_ran = large_ran || *job == 1;
    }
    schedule.end(running.front());  // one at a time: there is never a moment when nothing runs by chance
    running.erase(running.begin());
  }
  EXPECT_TRUE(large_ran);
  EXPECT_LE(starts, 5U);
}

TEST(Schedule, AJobThatIsTriedAgainGoesFirstWithItsNewNeed) {
  Schedule schedule({1, 10}, {2, 2, 2});
  EXPECT_EQ(schedule.start_next(), 0U);
  schedule.end(0);
  schedule.wait_again(0, 20);
  EXPECT_TRUE(schedule.needs_more_than_all(0));
  EXPECT_EQ(schedule.start_next(), 0U);
  EXPECT_EQ(schedule.start_next(), std::nullopt);
  schedule.end(0);
  EXPECT_EQ(schedule.start_next(), 1U);
  EXPECT_EQ(schedule.give_up(), (std::vector<std::size_t>{2}));
  schedule.end(1);
  EXPECT_EQ(schedule.start_next(), std::nullopt);
}

TEST(DefaultJobs, UsesTheProcessorsAndWhatTheGreatestJobLeavesOfMemory) {
  const std::vector<double> many(100, 1.0);
  EXPECT_EQ(default_jobs(1, 1000, many), 1);
  EXPECT_EQ(default_jobs(2, 1000, many), 2);
  EXPECT_EQ(default_jobs(64, 1000, many), 16);
  EXPECT_EQ(default_jobs(64, 5, many), 5);
  EXPECT_EQ(default_jobs(64, 1000, {1, 1, 1}), 3);
  EXPECT_EQ(default_jobs(64, 10, {1, 4, 1, 1, 1, 1, 1, 1}), 2);
  EXPECT_EQ(default_jobs(64, 10, {1, 50, 1, 1}), 4) << "what runs alone anyway limits nothing";
  EXPECT_EQ(default_jobs(64, 0.5, many), 16) << "if none fits all run alone, whatever the number";
  EXPECT_EQ(default_jobs(8, 10, {}), 1);
}

TEST(ShareOfThreads, NeverGivesOutMoreThanThereAre) {
  for (const int threads : {1, 2, 7, 64})
    for (const int jobs : {1, 2, 3, 8})
      for (std::size_t number = 1; number < 20; ++number) {
        int given = 0;
        for (int running = 0; running < jobs && static_cast<std::size_t>(running) < number; ++running)
          given += share_of_threads(threads, jobs, running, number - static_cast<std::size_t>(running) - 1);
        EXPECT_LE(given, std::max(threads, jobs)) << threads << " threads, " << jobs << " of " << number << " jobs";
      }
  EXPECT_EQ(share_of_threads(8, 4, 0, 0), 8) << "a lonely job gets all";
}

}  // namespace
}  // namespace softreel
