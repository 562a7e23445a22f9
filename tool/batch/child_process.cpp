#include "tool/batch/child_process.h"

#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.h"

namespace softreel {
namespace {

/// Ends a child that cannot become the program: 127, as shells do.
[[noreturn]] void give_up() {
  ::_exit(127);
}

/// In the child between fork and exec: calls that are safe there only (signal-safety(7)).
[[noreturn]] void become(char* const* arguments, pid_t parent, int out_end, int err_end) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) give_up();  // it ended before the line above
  const int badness = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (badness >= 0 && ::write(badness, "500", 3) < 0) ::close(badness);  // a wish; nothing is lost without it
  ::signal(SIGTERM, SIG_DFL);  // which ends it, though this program may have been started to ignore its own
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (::dup2(nothing, 0) < 0 || ::dup2(out_end, 1) < 0 || ::dup2(err_end, 2) < 0) give_up();
  ::execv(arguments[0], arguments);
  give_up();
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

std::string signal_text(int signal) {
  const char* name = ::sigabbrev_np(signal);
  return name == nullptr ? fmt::format("signal {}", signal) : fmt::format("signal {} (SIG{})", signal, name);
}

void ChildProcess::Pipe::read_what_is_there() {
  char part[65536];
  while (descriptor >= 0) {
    const ssize_t size = ::read(descriptor, part, sizeof part);
    if (size > 0) {
      text.append(part, static_cast<std::size_t>(size));
      if (text.size() > most) text.erase(most / 4, most / 2);
    } else if (size == 0 || (errno != EAGAIN && errno != EINTR)) {
      close();
    } else if (errno == EAGAIN) {
      return;
    }
  }
}

void ChildProcess::Pipe::close() {
  if (descriptor >= 0) ::close(descriptor);
  descriptor = -1;
}

void ChildProcess::start(std::vector<char*>& arguments, int out_end, int err_end) {
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ == 0) become(arguments.data(), parent, out_end, err_end);
}

ChildProcess::ChildProcess(std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  int out_ends[2] = {-1, -1}, err_ends[2] = {-1, -1};
  const bool has_pipes = ::pipe2(out_ends, O_CLOEXEC) == 0 && ::pipe2(err_ends, O_CLOEXEC) == 0;
  if (has_pipes) start(argv, out_ends[1], err_ends[1]);
  const int why = errno;
  for (const int end : {out_ends[1], err_ends[1]})
    if (end >= 0) ::close(end);
  out_.descriptor = out_ends[0];
  err_.descriptor = err_ends[0];
  if (pid_ < 0) {
    out_.close();
    err_.close();
    throw work_error(fmt::format("{}: cannot be started: {}.\n  Run fewer jobs at one time (--jobs).",
                                 arguments.front(), std::strerror(why)));
  }
  for (const int end : {out_.descriptor, err_.descriptor}) ::fcntl(end, F_SETFL, O_NONBLOCK);
}

ChildProcess::~ChildProcess() {
  if (!end_) {
    signal(SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) continue;
  }
  out_.close();
  err_.close();
}

void ChildProcess::signal(int number) const {
  if (!end_) ::kill(pid_, number);
}

std::optional<ProcessEnd> ChildProcess::poll() {
  if (end_) return end_;
  int status = 0;
  rusage usage{};
  const pid_t ended = ::wait4(pid_, &status, WNOHANG, &usage);
  out_.read_what_is_there();
  err_.read_what_is_there();
  if (ended != pid_) return std::nullopt;
  end_ = ProcessEnd{WIFEXITED(status) ? WEXITSTATUS(status) : 0, WIFSIGNALED(status) ? WTERMSIG(status) : 0,
                    seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime),
                    1024.0 * static_cast<double>(usage.ru_maxrss)};
  return end_;
}

void ChildProcess::wait_for_any(const std::vector<ChildProcess*>& children, int milliseconds) {
  std::vector<pollfd> descriptors;
  for (const ChildProcess* child : children)
    for (const int descriptor : {child->out_.descriptor, child->err_.descriptor})
      if (descriptor >= 0) descriptors.push_back({descriptor, POLLIN, 0});
  ::poll(descriptors.data(), descriptors.size(), milliseconds);
}

}  // namespace softreel
