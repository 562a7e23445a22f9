#include "tool/cache/process.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <mutex>
#include <set>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace softreel {
namespace {

/// Programs that run_process waits for. Each is in here for as long as its number is its own.
struct Children {
  std::mutex mutex;
  std::set<pid_t> running;
};

Children& children() {
  static auto& children = *new Children;  // for as long as any thread runs
  return children;
}

/// Attributes of a child that gets signals as any program does, whatever this one blocks, and SIGTERM even if this one
/// ignores it; but not those of our terminal: end_processes passes Ctrl-C on, once.
struct OpenToSignals {
  posix_spawnattr_t value;
  OpenToSignals() {
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_init(&value);
    posix_spawnattr_setsigmask(&value, &none);
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGTERM);
    posix_spawnattr_setsigdefault(&value, &ends);
    posix_spawnattr_setflags(&value, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~OpenToSignals() { posix_spawnattr_destroy(&value); }
};

/// Waits for a child's end and returns what waitpid says of it.
int wait_for(pid_t child) {
  // Its number is free once it is reaped: end_processes must not find it any more by then.
  siginfo_t ended;
  while (::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT) != 0 && errno == EINTR) continue;
  const std::lock_guard lock(children().mutex);
  children().running.erase(child);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return status;
}

std::string read_to_end(int descriptor) {
  std::string text;
  char part[4096];
  ssize_t size = 0;
  while ((size = ::read(descriptor, part, sizeof part)) > 0 || (size < 0 && errno == EINTR))
    if (size > 0) text.append(part, static_cast<std::size_t>(size));
  return text;
}

}  // namespace

int run_process(std::vector<std::string> arguments, std::string* said, const std::atomic<bool>* cancelled) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  int pipe_ends[2] = {-1, -1};
  if (said != nullptr && ::pipe2(pipe_ends, O_CLOEXEC) != 0) return -errno;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  if (said != nullptr) {
    posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], 1);
    posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], 2);
  }
  pid_t child = 0;
  int failed = 0;
  bool is_cancelled = false;
  {
    const OpenToSignals attributes;
    const std::lock_guard lock(children().mutex);
    is_cancelled = cancelled != nullptr && cancelled->load();
    if (!is_cancelled) failed = posix_spawnp(&child, argv[0], &actions, &attributes.value, argv.data(), environ);
    if (!is_cancelled && failed == 0) children().running.insert(child);
  }
  posix_spawn_file_actions_destroy(&actions);
  if (said != nullptr) {
    ::close(pipe_ends[1]);
    *said = read_to_end(pipe_ends[0]);
    ::close(pipe_ends[0]);
  }
  if (is_cancelled) return 128 + SIGTERM;
  if (failed != 0) return -failed;
  const int status = wait_for(child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string why_not_started(int status) {
  if (status == -ENOENT || status == 127) return "was not found";
  return status < 0 ? std::string("could not be started: ") + std::strerror(-status) : std::string();
}

void end_processes() {
  const std::lock_guard lock(children().mutex);
  for (const pid_t child : children().running) ::kill(child, SIGTERM);
}

}  // namespace softreel
