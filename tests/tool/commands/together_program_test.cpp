/// Two programs at once that share a cache, an output folder, or both.
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tool/commands/survival.h"

namespace softreel {
namespace {

using namespace softreel::testing;

constexpr const char* kShot = "--set shot.frames=[1,10] --set output.movie=true";
constexpr const char* kOther =
    "--set shot.frames=[1,10] --set output.movie=true --set environment.zenith=[0.9,0.2,0.1]";
/// Two start together, or the second in the middle of what the first does, ms.
constexpr int kOffsets[] = {0, 0, 15, 40, 80, 150, 300};

class Together : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = shot_folder("together");
    for (const auto& [name, options] : {std::pair{"/reference", kShot}, std::pair{"/other_reference", kOther}})
      render_in_peace(folder_, folder_ + name, options);
  }

  std::vector<std::string> command(const std::string& output, const std::string& options) const {
    return words_of(fmt::format("softreel render {}/shot.toml --output {} --cache {}/cache --quiet {}", folder_, output,
                                work_, options));
  }

  /// Runs both on a new cache; both succeed and find nothing damaged.
  void run_both(int offset, const std::string& outputs, const std::string& other_output, const std::string& options) {
    RunningProgram first("first", command(work_ + "/" + outputs, kShot));
    std::this_thread::sleep_for(std::chrono::milliseconds(offset));
    RunningProgram second("second", command(work_ + "/" + other_output, options));
    for (RunningProgram* program : {&first, &second}) {
      const Outcome outcome = program->wait();
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_EQ(outcome.err, "");
    }
  }

  /// Also the same names, dot-files too: no temporary file is left.
  void expect_as(const std::string& reference, const std::string& output) const {
    expect_equal_final_files(folder_ + "/" + reference, work_ + "/" + output);
    for (const std::string& form : name_forms(work_ + "/" + output))
      EXPECT_TRUE(name_forms(folder_ + "/" + reference).contains(form)) << form << " is left";
  }

  std::string folder_, work_;
};

TEST_F(Together, TheyMakeOneOutputOfOneShot) {
  for (const int offset : kOffsets) {
    SCOPED_TRACE(fmt::format("{} ms apart", offset));
    work_ = new_folder("together_work");
    run_both(offset, "out", "out", kShot);
    expect_as("reference", "out");
  }
}

/// Removed pictures would come back from the cache, as a rule before the other program misses them.
TEST_F(Together, TheSecondRemovesNothingThatTheFirstHasJustMade) {
  for (int seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(fmt::format("pauses of seed {}", seed));
    work_ = new_folder("together_work");
    std::vector<std::string> talking = command(work_ + "/out", kShot);
    std::erase(talking, "--quiet");
    const Abuse pauses{{"ROOT", work_}, {"PAUSE", std::to_string(seed)}};
    RunningProgram first("first", talking, pauses);
    std::this_thread::sleep_for(std::chrono::milliseconds(40 * seed));
    RunningProgram second("second", talking, pauses);
    for (RunningProgram* program : {&first, &second}) {
      const Outcome outcome = program->wait();
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_EQ(outcome.err.find("outdated pictures removed"), std::string::npos) << outcome.err;
    }
    expect_as("reference", "out");
  }
}

TEST_F(Together, TheyMakeTwoOutputsOfOneShot) {
  for (const int offset : kOffsets) {
    SCOPED_TRACE(fmt::format("{} ms apart", offset));
    work_ = new_folder("together_work");
    run_both(offset, "out", "second", kShot);
    expect_as("reference", "out");
    expect_as("reference", "second");
  }
}

TEST_F(Together, TheyMakeTwoShotsWithOneCache) {
  for (const int offset : kOffsets) {
    SCOPED_TRACE(fmt::format("{} ms apart", offset));
    work_ = new_folder("together_work");
    run_both(offset, "out", "second", kOther);
    expect_as("reference", "out");
    expect_as("other_reference", "second");
  }
}

TEST_F(Together, FourShareTheFramesOfAnOutput) {
  work_ = new_folder("together_work");
  std::vector<std::unique_ptr<RunningProgram>> programs;
  for (int k = 0; k < 4; ++k) {
    const std::string frames = fmt::format(" --frames {}-{}", std::max(1, 3 * k), std::min(10, 3 * k + 4));
    programs.push_back(std::make_unique<RunningProgram>(std::to_string(k), command(work_ + "/out", kShot + frames)));
  }
  for (const auto& program : programs) EXPECT_EQ(program->wait().status, 0) << program->err();
  // Whatever each knew of the others, the next run has nothing to trace.
  const auto report = render_in_peace(folder_, work_ + "/out", fmt::format("--cache {}/cache {}", work_, kShot));
  EXPECT_EQ(report["pictures"]["traced"], 0);
  expect_as("reference", "out");
}

}  // namespace
}  // namespace softreel
