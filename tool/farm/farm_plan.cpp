#include "tool/farm/farm_plan.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/check.h"

namespace softreel {
namespace {

void add_chunks(const FrameChunk& run, int size, std::vector<FrameChunk>& chunks) {
  const int count = (run.count() + size - 1) / size;
  int first = run.first;
  for (int i = 0; i < count; ++i) {
    const int length = (run.last - first + 1 + count - i - 1) / (count - i);
    chunks.push_back({first, first + length - 1});
    first += length;
  }
}

}  // namespace

const char* step_name(FarmStep step) {
  switch (step) {
    case FarmStep::Simulate:
      return "simulate";
    case FarmStep::Frames:
      return "frames";
    case FarmStep::Movie:
      return "movie";
  }
  return "";
}

std::string job_name(const FarmJob& job) {
  return job.number == 0 ? std::string(step_name(job.step)) : fmt::format("{}-{}", step_name(job.step), job.number + 1);
}

std::string task_name(FarmStep step, const FrameChunk& frames) {
  return step == FarmStep::Frames ? fmt::format("frames-{}-{}", frames.first, frames.last)
                                  : std::string(step_name(step));
}

std::vector<FrameChunk> chunks_of(const std::vector<int>& frames, int size) {
  CHECK(size >= 1);
  std::vector<FrameChunk> chunks;
  for (std::size_t begin = 0, end = 0; begin < frames.size(); begin = end) {
    for (end = begin + 1; end < frames.size() && frames[end] == frames[end - 1] + 1; ++end) continue;
    add_chunks({frames[begin], frames[end - 1]}, size, chunks);
  }
  return chunks;
}

std::vector<FarmJob> plan_jobs(const FarmWork& work, int chunk, std::size_t most_tasks) {
  CHECK(most_tasks > 0U);
  std::vector<FarmJob> jobs;
  std::vector<std::size_t> simulation, pictures;
  if (work.simulate) {
    simulation.push_back(jobs.size());
    jobs.push_back({FarmStep::Simulate, 0, {*work.simulate}, {}});
  }
  const std::vector<FrameChunk> chunks = chunks_of(work.frames, chunk);
  for (std::size_t begin = 0; begin < chunks.size(); begin += most_tasks) {
    const auto from = chunks.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto to = chunks.begin() + static_cast<std::ptrdiff_t>(std::min(begin + most_tasks, chunks.size()));
    const int number = static_cast<int>(pictures.size());
    pictures.push_back(jobs.size());
    jobs.push_back({FarmStep::Frames, number, {from, to}, simulation});
  }
  if (work.movie) jobs.push_back({FarmStep::Movie, 0, {*work.movie}, pictures.empty() ? simulation : pictures});
  return jobs;
}

}  // namespace softreel
