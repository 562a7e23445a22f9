#include "tool/commands/interruption.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <thread>

#include <unistd.h>

#include "tool/cache/file_lock.h"
#include "tool/cache/process.h"

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

/// Ctrl-C, a request to end, a terminal that is closed; but none that whoever started the program has it ignore, as
/// nohup does. A watched one would come all the same.
sigset_t signals_to_watch() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction inherited {};
    if (::sigaction(signal, nullptr, &inherited) != 0 || inherited.sa_handler != SIG_IGN) sigaddset(&signals, signal);
  }
  return signals;
}

void watch(sigset_t signals) {
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
  const sigset_t signals = signals_to_watch();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // every later thread inherits it: only the watch sees them
  std::thread(watch, signals).detach();
}

}  // namespace softreel
