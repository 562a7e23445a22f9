#include "core/base/thread_team.h"

#include <chrono>
#include <system_error>

#include "core/base/check.h"

namespace softreel {
namespace {

/// How long a helper waits awake: longer than the gaps between the loops of a solve, which are a few microseconds.
constexpr std::chrono::microseconds kAwake{40};

/// Pauses between two looks at the clock, and before a caller lets other threads run while it waits for helpers.
constexpr int kPauses = 32;
constexpr int kPausesBeforeYield = 2000;

}  // namespace

ThreadTeam::ThreadTeam(int helpers) : size_of_team_(helpers) {
  CHECK(helpers >= 1);
}

ThreadTeam::~ThreadTeam() {
  ending_ = true;
  ++jobs_;
  jobs_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void ThreadTeam::take_part() {
  for (std::int64_t k = next_.fetch_add(1); k < size_; k = next_.fetch_add(1)) (*body_)(k);
}

/// Where no more threads may be started (a limit of the container), those that there are do the work: the caller alone
/// ends every job too.
void ThreadTeam::start_helpers() {
  try {
    while (helpers_.size() < static_cast<std::size_t>(size_of_team_)) helpers_.emplace_back([this] { help(); });
  } catch (const std::system_error&) {
    size_of_team_ = static_cast<int>(helpers_.size());
  }
}

bool ThreadTeam::run(std::int64_t n, const std::function<void(std::int64_t)>& body) {
  if (taken_.exchange(true)) return false;
  start_helpers();
  body_ = &body;
  size_ = n;
  next_ = 0;
  open_ = true;
  ++jobs_;
  jobs_.notify_all();  // no system call unless somebody sleeps
  take_part();
  // A helper enters by ++active_ and then looks whether the job is open; both are sequentially consistent, so that
  // either it sees the closed door or it is counted here.
  open_ = false;
  for (int pauses = 0; active_ != 0; ++pauses) {
    if (pauses < kPausesBeforeYield)
      __builtin_ia32_pause();
    else
      std::this_thread::yield();
  }
  taken_ = false;
  return true;
}

/// Waits for a job after the `last` one, first awake, then asleep. False if the team is ending.
bool ThreadTeam::next_job(int& last) const {
  const auto until = std::chrono::steady_clock::now() + kAwake;
  while (jobs_ == last) {
    for (int pause = 0; pause < kPauses && jobs_ == last; ++pause) __builtin_ia32_pause();
    if (jobs_ == last && std::chrono::steady_clock::now() >= until) jobs_.wait(last);
  }
  last = jobs_;
  return !ending_;
}

void ThreadTeam::help() {
  int last = 0;
  while (next_job(last)) {
    ++active_;
    if (open_) take_part();
    --active_;
  }
}

}  // namespace softreel
