/// Ctrl-C in every phase: the program is soon gone, with status 130, and nothing of it stays but finished files.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tool/commands/survival.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using std::chrono::milliseconds;

/// What is promised is a second; a loaded machine gets more.
constexpr milliseconds kBound{5000};

/// A sphere of more rings is a large file.
constexpr int kLarge = 100;

void pause(milliseconds time) {
  std::this_thread::sleep_for(time);
}

/// Waits for something to be true, as long as the program runs.
void wait_until(RunningProgram& program, const std::function<bool()>& condition) {
  while (!program.has_ended() && !condition()) pause(milliseconds(2));
}

/// Whether the program has started another that still runs.
bool has_child(pid_t pid) {
  namespace fs = std::filesystem;
  std::error_code gone;
  for (const auto& thread : fs::directory_iterator(fmt::format("/proc/{}/task", pid), gone))
    if (!read_text(thread.path() / "children").empty()) return true;
  return false;
}

/// A phase of the work that lasts for seconds, and how to see from outside that the program is in it.
struct Phase {
  const char* name;
  std::string options;
  std::string prepare;  ///< a command whose results the phase finds in the cache; may be empty
  std::string command;
  int rings;  ///< of the sphere
  std::function<bool(const RunningProgram&)> has_begun;
  milliseconds later{0};  ///< until it is in the midst of it, where nothing can be seen from outside
};

void PrintTo(const Phase& phase, std::ostream* out) {
  *out << phase.name;
}

/// Whether a process is ready for the signal: it has a handler for it, or a thread that waits for it.
bool awaits_signal(pid_t pid, int number) {
  std::istringstream status(read_text(fmt::format("/proc/{}/status", pid)));
  std::uint64_t mask = 0;
  for (std::string word; status >> word;) {
    std::uint64_t signals = 0;
    if ((word == "SigCgt:" || word == "SigBlk:") && status >> std::hex >> signals) mask |= signals;
  }
  return (mask >> (number - 1) & 1U) != 0;
}

bool has_started(const RunningProgram& program) {
  return awaits_signal(program.pid(), SIGINT) && awaits_signal(program.pid(), SIGTERM);
}

bool has_loaded(const RunningProgram& program) {
  return program.err().find("triangles") != std::string::npos;
}

bool has_shown_progress(const RunningProgram& program) {
  return program.err().find("frames 1/") != std::string::npos;
}

const Phase kPhases[] = {
    {"Load", "--set body.ball.tets=300000", "", "simulate", 300, has_started},
    {"Tetrahedralize", "--set body.ball.tets=1000000", "", "simulate", 12, has_loaded},
    {"Equilibrium", "--set body.ball.tets=100000 --set shot.start=\"equilibrium\"", "", "simulate", 12, has_loaded,
     milliseconds(1500)},
    {"Simulate", "--set body.ball.tets=60000 --set shot.frames=[1,200]", "", "simulate", 12, has_shown_progress},
    {"Trace", "--set render.width=1920 --set render.height=1080 --set render.samples=1024", "simulate", "render", 12,
     has_loaded},
    {"Encode",
     "--set shot.frames=[1,200] --set render.width=640 --set render.height=360 --set shot.mode=\"static\" "
     "--set shot.independent=true --set body.ball.pull[0].keys=[{frame=1}] --set output.movie=true",
     "", "render", 12, [](const RunningProgram& program) { return has_child(program.pid()); }},
};

class Interrupt : public ::testing::TestWithParam<Phase> {
 protected:
  void SetUp() override {
    adopt_orphans();
    folder_ = shot_folder("interrupt");
    render_in_peace(folder_, folder_ + "/finished", "--set output.movie=true");
    // What is known of the files of a run that ended early: no temporary file, though a finished run folds it away.
    write_text(folder_ + "/finished/.ball.manifest.journal", "");
    write_text(folder_ + "/sphere.obj", sphere_obj(GetParam().rings));
    // The cache keeps what was read of a large file, too.
    if (GetParam().rings > kLarge)
      render_in_peace(folder_, folder_ + "/finished", "--set body.ball.tets=1000", "simulate");
    if (!GetParam().prepare.empty()) render_in_peace(folder_, output(), GetParam().options, GetParam().prepare);
  }

  /// These shots are larger than others; what they leave is of use only to find a mistake.
  void TearDown() override {
    if (!HasFailure()) std::filesystem::remove_all(folder_);
  }

  std::string output() const { return folder_ + "/out"; }

  /// Sends the signal `delay` after the phase began. Returns how long the program lived on.
  milliseconds interrupt(RunningProgram& program, int signal, milliseconds delay) const {
    wait_until(program, [&] { return GetParam().has_begun(program); });
    pause(delay + GetParam().later);
    EXPECT_FALSE(program.has_ended()) << "the signal came too late to test anything";
    const auto sent = std::chrono::steady_clock::now();
    program.signal(signal);
    const auto time = [&] { return std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - sent); };
    wait_until(program, [&] { return time() > kBound; });
    EXPECT_TRUE(program.has_ended()) << "still there after " << kBound.count() << " ms";
    return time();
  }

  /// No name of a form that a finished run does not leave, in the output and in the cache within it.
  void expect_no_temporary_file() const {
    if (!exists(output())) return;
    const auto finished = name_forms(folder_ + "/finished");
    for (const std::string& form : name_forms(output())) EXPECT_TRUE(finished.contains(form)) << form << " is left";
  }

  void expect_gone(int signal, milliseconds delay) const {
    SCOPED_TRACE(fmt::format("signal {} after {} ms", signal, delay.count()));
    const Phase& phase = GetParam();
    RunningProgram program("interrupt", words_of(fmt::format("softreel {} {}/shot.toml --output {} {}", phase.command,
                                                             folder_, output(), phase.options)));
    const milliseconds lived = interrupt(program, signal, delay);
    fmt::print("[ MEASURED ] {}: gone {} ms after signal {}\n", phase.name, lived.count(), signal);
    if (!program.has_ended()) return;
    const Outcome outcome = program.wait();
    EXPECT_FALSE(has_living_orphan()) << "a process that it started still runs";
    EXPECT_EQ(outcome.status, 130) << outcome.err;
    EXPECT_EQ(outcome.err.find("mistake in softreel"), std::string::npos) << outcome.err;
    expect_no_temporary_file();
  }

  std::string folder_;
};

TEST_P(Interrupt, ByCtrlCEndsSoonAndLeavesNothing) {
  expect_gone(SIGINT, milliseconds(0));
  expect_gone(SIGINT, milliseconds(200));
}

TEST_P(Interrupt, ByTerminationEndsSoonAndLeavesNothing) {
  expect_gone(SIGTERM, milliseconds(100));
}

TEST_P(Interrupt, ByAClosedTerminalEndsSoonAndLeavesNothing) {
  expect_gone(SIGHUP, milliseconds(100));
}

/// Reading a large file holds the lock on its result, and no signal is looked at meanwhile.
using InterruptTwice = Interrupt;

TEST_P(InterruptTwice, EndsAtOnceAndLeavesNoLockAndNoMarkOfARun) {
  // On a busy machine the reading may be over before the second signal comes: then another run is tried.
  constexpr int kTries = 5;
  bool in_time = false;
  for (int attempt = 1; attempt <= kTries && !in_time; ++attempt) {
    const std::string out = fmt::format("{}/twice{}", folder_, attempt);
    RunningProgram program("interrupt_twice",
                           words_of(fmt::format("softreel {} {}/shot.toml --output {} {}", GetParam().command, folder_,
                                                out, GetParam().options)));
    const auto has = [&](std::string_view part) {
      if (!exists(out)) return false;
      const std::vector<std::string> names = files_under(out);
      return std::any_of(names.begin(), names.end(),
                         [&](const std::string& name) { return name.find(part) != std::string::npos; });
    };
    wait_until(program, [&] { return has("/locks/") && has(".running"); });
    program.signal(SIGINT);
    pause(milliseconds(20));
    in_time = !program.has_ended();
    program.signal(SIGINT);
    const Outcome outcome = program.wait();
    if (!in_time) continue;
    EXPECT_EQ(outcome.status, 130);
    EXPECT_FALSE(has("/locks/"));
    EXPECT_FALSE(has(".running"));
  }
  EXPECT_TRUE(in_time) << "the second signal came too late to test anything";
}

/// As under nohup, or in the background of a shell.
TEST(InterruptIgnored, BySignalsThatTheProgramWasStartedToIgnoreStopsNothing) {
  const std::string folder = shot_folder("interrupt_ignored");
  RunningProgram program("interrupt_ignored",
                         {"sh", "-c",
                          fmt::format("trap '' HUP INT; exec '{0}' render {1}/shot.toml --output {1}/out --quiet --set "
                                      "'shot.frames=[1,20]' --set render.samples=16",
                                      SOFTREEL_PROGRAM, folder)});
  wait_until(program, [&] { return exists(folder + "/out/ball.0001.png"); });
  EXPECT_FALSE(program.has_ended()) << "the signals come too late to test anything";
  for (const int signal : {SIGHUP, SIGINT}) program.signal(signal);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(exists(folder + "/out/ball.0020.png"));
}

TEST(InterruptNew, SaysThatNothingIsKept) {
  const std::string folder = new_folder("interrupt_new");
  write_text(folder + "/sphere.obj", sphere_obj(kLarge));
  RunningProgram program("interrupt_new",
                         words_of(fmt::format("softreel new {0}/sphere.obj -o {0}/new.toml --tets 1000000", folder)));
  wait_until(program, [&] { return has_started(program); });
  pause(milliseconds(50));
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_NE(outcome.err.find("nothing is kept to go on from"), std::string::npos) << outcome.err;
  EXPECT_FALSE(exists(folder + "/new.toml"));
}

INSTANTIATE_TEST_SUITE_P(Phases, InterruptTwice, ::testing::Values(kPhases[0]),
                         [](const auto& phase) { return std::string(phase.param.name); });
INSTANTIATE_TEST_SUITE_P(Phases, Interrupt, ::testing::ValuesIn(kPhases),
                         [](const auto& phase) { return std::string(phase.param.name); });

}  // namespace
}  // namespace softreel
