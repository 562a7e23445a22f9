/// Batches whose jobs are killed, crash or are interrupted: the others do not notice, and nothing finished is lost.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tool/commands/survival.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;
using std::chrono::milliseconds;

/// Long enough for a signal to find it at work, and many frames, so that some are done by then.
constexpr const char* kSlow = "--set shot.frames=[1,40] --set render.samples=24";

class BatchSurvival : public ::testing::Test {
 protected:
  void SetUp() override {
    adopt_orphans();
    folder_ = shot_folder("batch_survival");
    std::string second = sphere_shot();
    second.replace(second.find("\"ball\""), 6, "\"second\"");
    second.replace(second.find("zenith = [0.6"), 13, "zenith = [0.9");
    write_text(folder_ + "/second.toml", second);
  }

  std::vector<std::string> command(const std::string& more) const {
    return words_of(fmt::format("softreel batch {0}/shot.toml {0}/second.toml --output {0}/out --json {1} {2}", folder_,
                                kSlow, more));
  }

  /// The process among the children of `parent` that renders a shot; 0 while there is none.
  static pid_t child_that_renders(pid_t parent, const std::string& shot) {
    std::error_code gone;
    for (const auto& thread : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", parent), gone)) {
      std::istringstream children(read_text(thread.path() / "children"));
      for (pid_t pid = 0; children >> pid;) {
        const std::string words = read_text(fmt::format("/proc/{}/cmdline", pid));
        if (words.find(shot) != std::string::npos && words.find("--dry-run") == std::string::npos) return pid;
      }
    }
    return 0;
  }

  /// Waits until the shot's job has finished a frame; its process.
  pid_t wait_for_frame(RunningProgram& program, const std::string& shot, const std::string& picture) const {
    while (!program.has_ended() && !exists(folder_ + "/out/" + picture)) std::this_thread::sleep_for(milliseconds(2));
    return child_that_renders(program.pid(), shot);
  }

  std::string folder_;
};

TEST_F(BatchSurvival, AJobThatIsKilledOrAbortsTouchesNoOther) {
  for (const int signal : {SIGKILL, SIGABRT}) {
    SCOPED_TRACE(signal);
    std::filesystem::remove_all(folder_ + "/out");
    RunningProgram program("batch", command("--jobs 2"));
    const pid_t child = wait_for_frame(program, "second.toml", "second.0003.png");
    ASSERT_NE(child, 0);
    ASSERT_EQ(::kill(child, signal), 0);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    const json report = json::parse(outcome.out);
    EXPECT_EQ(report["jobs"][0]["state"], "done");
    EXPECT_EQ(report["jobs"][1]["state"], "failed");
    EXPECT_EQ(report["jobs"][1]["signal"], signal);
    EXPECT_NE(report["jobs"][1]["message"].get<std::string>().find(signal == SIGKILL ? "SIGKILL" : "SIGABRT"),
              std::string::npos);
    EXPECT_TRUE(exists(folder_ + "/out/ball.0040.png"));
    EXPECT_TRUE(exists(folder_ + "/out/second.0003.png"));
    EXPECT_NE(read_text(folder_ + "/out/batch.junit.xml").find("<error "), std::string::npos);
  }
  // Again: one is up to date, the other goes on where it was.
  const Outcome again =
      run_abused(fmt::format("batch {0}/shot.toml {0}/second.toml --output {0}/out --json {1}", folder_, kSlow), {});
  ASSERT_EQ(again.status, 0) << again.err;
  const json report = json::parse(again.out);
  EXPECT_EQ(report["jobs"][0]["state"], "up to date");
  EXPECT_EQ(report["jobs"][1]["state"], "done");
  EXPECT_LE(report["jobs"][1]["traced"].get<int>(), 37);
  const json frames = json::parse(read_text(folder_ + "/out/second.report.json"))["energies"][0]["frames"];
  EXPECT_EQ(frames.size(), 40U) << "energies of the frames before the crash are known too";
}

TEST_F(BatchSurvival, ACrashedJobIsTriedAgainAsOftenAsAsked) {
  RunningProgram program("batch", command("--jobs 2 --retry 1"));
  const pid_t child = wait_for_frame(program, "second.toml", "second.0002.png");
  ASSERT_NE(child, 0);
  ASSERT_EQ(::kill(child, SIGSEGV), 0);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report["jobs"][1]["state"], "done");
  EXPECT_EQ(report["jobs"][1]["attempts"], 2);
  EXPECT_EQ(report["jobs"][0]["attempts"], 1);
  render_in_peace(folder_, folder_ + "/reference", kSlow);
  for (const auto& [name, bytes] : pictures_in(folder_ + "/reference"))
    EXPECT_TRUE(read_text(folder_ + "/out/" + name) == bytes) << name;
}

TEST_F(BatchSurvival, CtrlCOrAClosedTerminalEndsAllJobsAndKeepsTheirFrames) {
  for (const int signal : {SIGINT, SIGHUP}) {
    SCOPED_TRACE(signal);
    std::filesystem::remove_all(folder_ + "/out");
    RunningProgram program("batch", command("--jobs 1"));
    const pid_t child = wait_for_frame(program, "shot.toml", "ball.0002.png");
    ASSERT_NE(child, 0);
    program.signal(signal);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.status, 130) << outcome.err;
    EXPECT_NE(::kill(child, 0), 0) << "a job outlives the batch";
    EXPECT_TRUE(exists(folder_ + "/out/ball.0001.png"));
    const json report = json::parse(read_text(folder_ + "/out/batch.json"));
    EXPECT_TRUE(report["interrupted"].get<bool>());
    EXPECT_EQ(report["jobs"][0]["state"], "interrupted");
    EXPECT_EQ(report["jobs"][1]["state"], "not started");
    EXPECT_NE(read_text(folder_ + "/out/batch.junit.xml").find("<skipped/>"), std::string::npos);
  }
}

TEST_F(BatchSurvival, ABatchThatIsKilledTakesItsJobsWithIt) {
  RunningProgram program("batch", command("--jobs 2"));
  wait_for_frame(program, "shot.toml", "ball.0002.png");
  program.signal(SIGKILL);
  EXPECT_EQ(program.wait().status, 128 + SIGKILL);
  EXPECT_TRUE(wait_for_orphans());
}

/// The address space of each program is limited: a job that wants more fails with its message, the other is done.
TEST_F(BatchSurvival, AJobThatRunsOutOfMemoryTouchesNoOther) {
  const Outcome outcome =
      run(fmt::format("ulimit -v 6000000; softreel batch {0}/shot.toml --output {0}/out --json --jobs 2 --frames 1 "
                      "--set render.samples=1 --sweep render.width=32,32768 --set render.height=20000",
                      folder_));
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report["jobs"][0]["state"], "done");
  EXPECT_EQ(report["jobs"][1]["state"], "failed");
  EXPECT_NE(report["jobs"][1]["message"].get<std::string>().find("memory"), std::string::npos)
      << report["jobs"][1]["message"];
}

}  // namespace
}  // namespace softreel
