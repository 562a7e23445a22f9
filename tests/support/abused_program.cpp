#include "tests/support/abused_program.h"

#include <chrono>
#include <csignal>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace softreel::testing {

namespace {

std::vector<std::string> environment_with(const Abuse& abuse) {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) variables.emplace_back(*variable);
  if (abuse.empty()) return variables;
  variables.push_back(fmt::format("LD_PRELOAD={}", SOFTREEL_ABUSE_LIBRARY));
  for (const auto& [name, value] : abuse) variables.push_back(fmt::format("ABUSE_{}={}", name, value));
  return variables;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Attributes of a program that ignores no signal, though the test may have been started in the background.
struct OpenToSignals {
  posix_spawnattr_t value;
  OpenToSignals() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
    posix_spawnattr_init(&value);
    posix_spawnattr_setsigdefault(&value, &signals);
    posix_spawnattr_setflags(&value, POSIX_SPAWN_SETSIGDEF);
  }
  ~OpenToSignals() { posix_spawnattr_destroy(&value); }
};

}  // namespace

RunningProgram::RunningProgram(const std::string& name, std::vector<std::string> arguments, const Abuse& abuse)
    : folder_(new_folder("running_" + name)) {
  if (arguments.at(0) == "softreel") arguments[0] = SOFTREEL_PROGRAM;
  std::vector<std::string> variables = environment_with(abuse);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const std::string out = folder_ + "/out", err = folder_ + "/err";
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const OpenToSignals attributes;
  const int failed = posix_spawnp(&pid_, arguments[0].c_str(), &actions, &attributes.value,
                                  pointers_to(arguments).data(), pointers_to(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw std::runtime_error(arguments[0] + ": " + std::strerror(failed));
}

RunningProgram::~RunningProgram() {
  if (ended_) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

void RunningProgram::signal(int number) const {
  if (!ended_) ::kill(pid_, number);
}

bool RunningProgram::has_ended() {
  if (!ended_) ended_ = ::waitpid(pid_, &status_, WNOHANG) == pid_;
  return ended_;
}

std::string RunningProgram::err() const {
  return read_text(folder_ + "/err");
}

Outcome RunningProgram::wait() {
  while (!ended_) {
    const pid_t waited = ::waitpid(pid_, &status_, 0);
    if (waited < 0 && errno != EINTR) throw std::runtime_error("the program was waited for twice");
    ended_ = waited == pid_;
  }
  Outcome outcome;
  outcome.status = WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  outcome.out = read_text(folder_ + "/out");
  outcome.err = read_text(folder_ + "/err");
  return outcome;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

Outcome run_abused(const std::string& arguments, const Abuse& abuse) {
  return RunningProgram("abused", words_of("softreel " + arguments), abuse).wait();
}

Counted read_counts(const std::string& count_file) {
  const std::string bytes = read_text(count_file);
  if (bytes.size() != 2 * sizeof(std::uint64_t)) throw std::runtime_error(count_file + ": nothing was counted");
  Counted counted;
  std::memcpy(&counted.calls, bytes.data(), sizeof(counted.calls));
  std::memcpy(&counted.bytes, bytes.data() + sizeof(counted.calls), sizeof(counted.bytes));
  return counted;
}

void adopt_orphans() {
  if (::prctl(PR_SET_CHILD_SUBREAPER, 1) != 0) throw std::runtime_error("no sub-reaper");
}

bool has_living_orphan() {
  for (;;) {
    const pid_t ended = ::waitpid(-1, nullptr, WNOHANG);
    if (ended == 0) return true;
    if (ended < 0) return false;  // no child at all
  }
}

bool wait_for_orphans() {
  for (int i = 0; i < 6000 && has_living_orphan(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return !has_living_orphan();
}

std::vector<std::string> lines_with(const std::string& text, const std::string& part) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
    if (line.find(part) != std::string::npos) lines.push_back(line);
  return lines;
}

}  // namespace softreel::testing
