#include "tool/batch/child_process.h"

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.h"

namespace softreel {
namespace {

ProcessEnd wait_for(ChildProcess& child) {
  while (true) {
    if (const auto end = child.poll()) return *end;
    ChildProcess::wait_for_any({&child}, 50);
  }
}

ProcessEnd run_shell(const std::string& script) {
  ChildProcess child({"/bin/sh", "-c", script});
  return wait_for(child);
}

bool is_alive(pid_t pid) {
  return ::kill(pid, 0) == 0;
}

TEST(ChildProcess, TellsAStatusFromASignal) {
  EXPECT_EQ(run_shell("exit 3").status, 3);
  EXPECT_EQ(run_shell("exit 3").signal, 0);
  EXPECT_EQ(run_shell("kill -ABRT $$").signal, SIGABRT);
  EXPECT_EQ(run_shell("kill -KILL $$").signal, SIGKILL);
  EXPECT_EQ(signal_text(SIGSEGV), "signal 11 (SIGSEGV)");
}

TEST(ChildProcess, ReadsAllOfBothOutputsWithoutBlockingTheChild) {
  ChildProcess child(
      {"/bin/sh", "-c", "i=0; while [ $i -lt 20000 ]; do echo 0123456789; echo err >&2; i=$((i+1)); done"});
  EXPECT_EQ(wait_for(child).status, 0);
  EXPECT_EQ(child.out().size(), 20000U * 11);
  EXPECT_EQ(child.err().size(), 20000U * 4);
}

TEST(ChildProcess, DoesNotWaitForAGrandchildThatHoldsThePipe) {
  const auto start = std::chrono::steady_clock::now();
  ChildProcess child({"/bin/sh", "-c", "sleep 20 & echo $!"});
  EXPECT_EQ(wait_for(child).status, 0);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(15));
  ::kill(std::stoi(child.out()), SIGKILL);
}

TEST(ChildProcess, MeasuresMemoryAndProcessorTime) {
  const ProcessEnd end = run_shell("i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done");
  EXPECT_GT(end.cpu_seconds, 0);
  EXPECT_GT(end.peak_bytes, 1e5);
}

TEST(ChildProcess, IsEndedWhenItsObjectGoes) {
  pid_t pid = 0;
  {
    const ChildProcess child({"/bin/sleep", "60"});
    pid = child.pid();
    EXPECT_TRUE(is_alive(pid));
  }
  EXPECT_FALSE(is_alive(pid));
}

/// A scheduler that is killed takes its children with it: the kernel sees to that.
TEST(ChildProcess, DoesNotOutliveAParentThatIsKilled) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t parent = ::fork();
  if (parent == 0) {
    const ChildProcess child({"/bin/sleep", "60"});
    const pid_t pid = child.pid();
    if (::write(ends[1], &pid, sizeof pid) != sizeof pid) ::_exit(1);
    ::pause();
    ::_exit(0);
  }
  pid_t grandchild = 0;
  ASSERT_EQ(::read(ends[0], &grandchild, sizeof grandchild), static_cast<ssize_t>(sizeof grandchild));
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  const auto is_gone = [&] {
    std::ifstream status("/proc/" + std::to_string(grandchild) + "/stat");
    std::string text((std::istreambuf_iterator<char>(status)), {});
    return text.empty() || text.find(") Z ") != std::string::npos;
  };
  for (int k = 0; k < 1000 && !is_gone(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(is_gone());
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(ChildProcess, AProgramThatIsNotThereEndsAsInAShell) {
  ChildProcess child({"/no/such/program"});
  EXPECT_EQ(wait_for(child).status, 127);
}

}  // namespace
}  // namespace softreel
