#include "tool/commands/interruption.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <thread>

#include <unistd.h>

#include "tool/stages/file_lock.h"
#include "tool/stages/process.h"

namespace softreel {
namespace {

/// A second, less what ending takes.
constexpr timespec kPatienceAlone{0, 700'000'000};
/// Children of the same program take a second, and have two.
constexpr timespec kPatienceWithChildren{4, 0};

std::atomic<bool>& has_children() {
  static std::atomic<bool> children{false};
  return children;
}

std::atomic<bool>& keeps_nothing() {
  static std::atomic<bool> nothing{false};
  return nothing;
}

sigset_t watched_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

void watch() {
  const sigset_t signals = watched_signals();
  int signal = 0;
  if (sigwait(&signals, &signal) != 0) return;
  cancellation() = true;
  end_processes();
  const timespec patience = has_children() ? kPatienceWithChildren : kPatienceAlone;
  while (sigtimedwait(&signals, nullptr, &patience) < 0 && errno == EINTR) continue;
  // Still here: time is up, or a second signal came.
  std::fprintf(stderr, "\nsoftreel: %s\n",
               interruption_message("Interrupted; what is finished is kept. Run the same command again to go on."));
  std::fflush(stderr);
  remove_lock_files_at_once();
  ::_exit(130);
}

}  // namespace

std::atomic<bool>& cancellation() {
  static std::atomic<bool> cancelled{false};
  return cancelled;
}

const char* interruption_message(const char* usual) {
  return keeps_nothing() ? "Interrupted; nothing is kept to go on from. Run the same command again to start anew."
                         : usual;
}

void keep_nothing_when_interrupted() {
  keeps_nothing() = true;
}

void wait_for_children_when_interrupted() {
  has_children() = true;
}

void watch_for_interruption() {
  cancellation() = false;
  const sigset_t signals = watched_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // every later thread inherits it: only the watch sees them
  std::thread(watch).detach();
}

}  // namespace softreel
