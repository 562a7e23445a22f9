#include "tool/farm/farm_plan.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace softreel {
namespace {

std::vector<int> frames_of(const std::vector<FrameChunk>& ranges) {
  std::vector<int> frames;
  for (const FrameChunk& range : ranges)
    for (int frame = range.first; frame <= range.last; ++frame) frames.push_back(frame);
  return frames;
}

std::vector<int> range(int first, int last) {
  return frames_of({{first, last}});
}

TEST(FarmPlan, ChunksCoverEveryFrameExactlyOnce) {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    std::set<int> some;
    const int count = std::uniform_int_distribution<int>(0, 60)(random);
    for (int i = 0; i < count; ++i) some.insert(std::uniform_int_distribution<int>(-20, 60)(random));
    const std::vector<int> frames(some.begin(), some.end());
    const int size = std::uniform_int_distribution<int>(1, 12)(random);
    const std::vector<FrameChunk> chunks = chunks_of(frames, size);
    EXPECT_EQ(frames_of(chunks), frames);
    for (const FrameChunk& chunk : chunks) {
      EXPECT_GE(chunk.count(), 1);
      EXPECT_LE(chunk.count(), size);
    }
  }
}

TEST(FarmPlan, ChunksAreAsEqualAsCanBeAndNoMoreThanNeeded) {
  const std::vector<FrameChunk> chunks = chunks_of(range(1, 13), 5);
  ASSERT_EQ(chunks.size(), 3U);
  for (const FrameChunk& chunk : chunks) EXPECT_TRUE(chunk.count() == 4 || chunk.count() == 5) << chunk.count();
}

TEST(FarmPlan, MakesOneChunkOfAHugeSize) {
  EXPECT_EQ(chunks_of(range(1, 9), 2000000000), (std::vector<FrameChunk>{{1, 9}}));
}

TEST(FarmPlan, EveryJobWaitsForAllThatItNeeds) {
  const std::vector<FarmJob> jobs = plan_jobs({FrameChunk{1, 41}, range(1, 40), FrameChunk{1, 40}}, 4, 3);
  std::set<std::size_t> simulation, pictures;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const std::set<std::size_t> after(jobs[i].after.begin(), jobs[i].after.end());
    for (const std::size_t before : after) EXPECT_LT(before, i) << "it could not be submitted in this order";
    if (jobs[i].step == FarmStep::Simulate) {
      EXPECT_TRUE(after.empty());
      simulation.insert(i);
    } else if (jobs[i].step == FarmStep::Frames) {
      EXPECT_EQ(after, simulation);
      EXPECT_LE(jobs[i].tasks.size(), 3U);
      pictures.insert(i);
    } else {
      EXPECT_EQ(after, pictures);
    }
  }
  EXPECT_EQ(simulation.size(), 1U);
  EXPECT_EQ(pictures.size(), 4U);
  EXPECT_EQ(jobs.back().step, FarmStep::Movie);
}

TEST(FarmPlan, JobsTogetherHoldEveryFrameOnce) {
  std::vector<int> made;
  for (const FarmJob& job : plan_jobs({{}, range(5, 33), {}}, 2, 4))
    for (const int frame : frames_of(job.tasks)) made.push_back(frame);
  EXPECT_EQ(made, range(5, 33));
}

TEST(FarmPlan, NamesOfTasksAndJobsAreDifferent) {
  std::set<std::string> jobs, tasks;
  std::size_t job_count = 0, task_count = 0;
  for (const FarmJob& job : plan_jobs({FrameChunk{1, 9}, range(1, 9), FrameChunk{1, 9}}, 1, 2)) {
    jobs.insert(job_name(job));
    job_count += 1;
    for (const FrameChunk& task : job.tasks) {
      tasks.insert(task_name(job.step, task));
      task_count += 1;
    }
  }
  EXPECT_EQ(jobs.size(), job_count);
  EXPECT_EQ(tasks.size(), task_count);
}

TEST(FarmPlan, LeavesOutWhatIsThere) {
  EXPECT_TRUE(plan_jobs({}, 5, 10).empty());
  const std::vector<FarmJob> movie = plan_jobs({{}, {}, FrameChunk{1, 4}}, 5, 10);
  ASSERT_EQ(movie.size(), 1U);
  EXPECT_EQ(movie[0].step, FarmStep::Movie);
  EXPECT_TRUE(movie[0].after.empty());
  const std::vector<FarmJob> frames = plan_jobs({{}, {3, 4, 9}, {}}, 5, 10);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].tasks, (std::vector<FrameChunk>{{3, 4}, {9, 9}}));
  EXPECT_TRUE(frames[0].after.empty());
}

}  // namespace
}  // namespace softreel
