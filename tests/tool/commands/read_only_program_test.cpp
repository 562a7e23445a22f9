/// Folders that cannot be written: the output's is said before the work, the cache's stops only what needs it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tool/commands/survival.h"

namespace softreel {
namespace {

using namespace softreel::testing;

constexpr const char* kReadOnlyFrames = "--set shot.frames=[1,8]";

class ReadOnly : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = shot_folder("read_only");
    render_in_peace(folder_, folder_ + "/reference",
                    fmt::format("--cache {}/reference_cache {}", folder_, kReadOnlyFrames));
  }

  Outcome run_in(const std::string& read_only, const std::string& command, const std::string& output,
                 const std::string& more = "") const {
    return run_abused(fmt::format("{0} {1}/shot.toml --output {1}/{2} --cache {1}/cache {3} {4}", command, folder_,
                                  output, kReadOnlyFrames, more),
                      {{"READ_ONLY", folder_ + "/" + read_only}});
  }

  void expect_one_warning_of_the_cache(const Outcome& outcome) const {
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto warnings = lines_with(outcome.err, "warning: ");
    ASSERT_EQ(warnings.size(), 1U) << outcome.err;
    EXPECT_NE(warnings[0].find(folder_ + "/cache"), std::string::npos) << warnings[0];
  }

  std::string folder_;
};

TEST_F(ReadOnly, OutputFolderIsNamedBeforeAnythingIsTraced) {
  write_text(new_folder("read_only/there") + "/mine.txt", "");
  for (const char* output : {"there", "there/new"}) {
    const Outcome outcome = run_in("there", "render", output);
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_EQ(lines_with(outcome.err, "softreel: ").size(), 1U) << outcome.err;
    EXPECT_NE(outcome.err.find(folder_ + "/there"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("Read-only file system"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("traced"), std::string::npos) << outcome.err;
    EXPECT_EQ(files_under(folder_ + "/there"), std::vector<std::string>{"mine.txt"});
  }
}

TEST_F(ReadOnly, CacheIsUsedAsFarAsItGoes) {
  const auto simulated =
      render_in_peace(folder_, folder_ + "/first",
                      fmt::format("--cache {}/cache {} --frames 1-5", folder_, kReadOnlyFrames), "simulate");
  ASSERT_EQ(simulated["simulation"]["computed"], 5);
  const auto stored = files_under(folder_ + "/cache");
  const Outcome outcome = run_in("cache", "render", "out", "--quiet --json");
  expect_one_warning_of_the_cache(outcome);
  ASSERT_EQ(outcome.status, 0);
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["simulation"]["loaded"], 5);
  expect_equal_final_files(folder_ + "/reference", folder_ + "/out");
  EXPECT_EQ(files_under(folder_ + "/cache"), stored);
}

TEST_F(ReadOnly, CacheThatCannotBeMadeIsSaidOnce) {
  expect_one_warning_of_the_cache(run_in("cache", "render", "out", "--quiet"));
  expect_equal_final_files(folder_ + "/reference", folder_ + "/out");
  EXPECT_FALSE(exists(folder_ + "/cache"));
}

TEST_F(ReadOnly, CacheStopsNoExport) {
  render_in_peace(folder_, folder_ + "/exported",
                  fmt::format("--cache {}/reference_cache {} --format obj", folder_, kReadOnlyFrames), "export");
  expect_one_warning_of_the_cache(run_in("cache", "export", "out", "--format obj --quiet"));
  expect_equal_final_files(folder_ + "/exported", folder_ + "/out");
}

TEST_F(ReadOnly, CacheThatCannotBeCleanedIsSaid) {
  render_in_peace(folder_, folder_ + "/first", fmt::format("--cache {}/cache --frames 1-2", folder_), "simulate");
  const auto stored = files_under(folder_ + "/cache");
  const Outcome outcome = run_in("cache", "clean", "first", "--all");
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.err.find(folder_ + "/cache/2/"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("Read-only file system"), std::string::npos) << outcome.err;
  EXPECT_EQ(files_under(folder_ + "/cache"), stored);
}

TEST_F(ReadOnly, CacheStopsASimulationWhichMakesNothingElse) {
  const Outcome outcome = run_in("cache", "simulate", "out", "--quiet");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(lines_with(outcome.err, "softreel: ").size(), 1U) << outcome.err;
  EXPECT_NE(outcome.err.find(folder_ + "/cache"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace softreel
