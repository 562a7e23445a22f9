#include "core/base/parallel.h"

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/version.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/library_version.h"
#include "core/base/thread_team.h"

namespace softreel {

namespace {

int processors() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// The failure of the first chunk that failed: exceptions are carried over the loop as values.
void rethrow_first(const std::vector<std::exception_ptr>& failures) {
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace

struct Threads::Arena {
  explicit Arena(int count)
      : limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(std::max(count, processors()))),
        arena(count) {
    if (count > 1) team = std::make_unique<ThreadTeam>(count - 1);
  }
  // Without it oneTBB grants no more threads than processors, and says so on standard error.
  tbb::global_control limit;
  tbb::task_arena arena;
  std::unique_ptr<ThreadTeam> team;  ///< none for one thread
};

Threads::Threads(int count, const std::atomic<bool>* stop) : count_(count == 0 ? processors() : count), stop_(stop) {
  CHECK(count >= 0);
  arena_ = std::make_unique<Arena>(count_);
}

Threads::~Threads() = default;

void Threads::stop_if_asked() const {
  if (stop_ != nullptr && *stop_) throw interrupted();
}

void Threads::for_chunks(std::int64_t n, std::int64_t grain, const ChunkBody& body) const {
  CHECK(grain > 0);
  const std::int64_t chunks = (n + grain - 1) / grain;
  if (chunks <= 0) return;
  stop_if_asked();
  if (count_ == 1 || chunks == 1) {
    for (std::int64_t k = 0; k < chunks; ++k) {
      stop_if_asked();
      body(k * grain, std::min(n, (k + 1) * grain));
    }
    return;
  }
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(chunks));
  const auto run_chunk = [&](std::int64_t k) {
    try {
      stop_if_asked();
      body(k * grain, std::min(n, (k + 1) * grain));
    } catch (...) {
      failures[static_cast<std::size_t>(k)] = std::current_exception();
    }
  };
  // The team serves one loop at a time; loops beside it and inside of it share TBB's threads.
  if (!arena_->team->run(chunks, run_chunk))
    arena_->arena.execute([&] { tbb::parallel_for(std::int64_t{0}, chunks, run_chunk); });
  rethrow_first(failures);
}

double Threads::sum_chunks(std::int64_t n, std::int64_t grain, const ChunkSum& body) const {
  CHECK(grain > 0);
  const std::int64_t chunks = std::max<std::int64_t>(0, (n + grain - 1) / grain);
  std::vector<double> partial(static_cast<std::size_t>(chunks), 0.0);
  for_chunks(n, grain, [&](std::int64_t begin, std::int64_t end) {
    partial[static_cast<std::size_t>(begin / grain)] = body(begin, end);
  });
  double sum = 0;
  for (const double part : partial) sum += part;
  return sum;
}

void Threads::run(const std::function<void()>& work) const {
  std::exception_ptr failure;
  arena_->arena.execute([&] {
    try {
      work();
    } catch (...) {
      failure = std::current_exception();
    }
  });
  if (failure) std::rethrow_exception(failure);
}

std::string thread_library_version() {
  const char* said = TBB_runtime_version();
  return said == nullptr ? "" : said;
}

}  // namespace softreel
