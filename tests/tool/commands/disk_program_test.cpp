/// Disks that are full, and calls that do less than was asked for.
#include <algorithm>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tool/commands/survival.h"

namespace softreel {
namespace {

using namespace softreel::testing;

constexpr const char* kDiskFrames = "--set shot.frames=[1,8]";

bool says_disk_is_full(const std::string& text) {
  return text.find("No space left on device") != std::string::npos || text.find("disk is full") != std::string::npos;
}

class DiskFull : public ::testing::Test {
 protected:
  void SetUp() override { folder_ = shot_folder("disk"); }

  std::string arguments(const std::string& output, const std::string& cache, const std::string& more) const {
    return fmt::format("{} {}/shot.toml --output {} --cache {} --quiet {} {}", command_, folder_, output, cache,
                       kDiskFrames, more);
  }

  /// Renders a reference and returns the bytes it wrote, those of the encoder too.
  std::uint64_t bytes_of_reference(const std::string& more = "") {
    const std::string root = new_folder("disk_reference");
    reference_ = root + "/out";
    const std::string count = folder_ + "/count";
    const Outcome outcome = run_abused(arguments(reference_, root + "/cache", more),
                                       {{"ROOT", root}, {"COUNT_FILE", count}, {"CHILDREN", "1"}});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return read_counts(count).bytes;
  }

  /// One message that names a file and the reason; every file that is there is whole; then, with space, all are.
  void expect_clear_end_and_recovery(std::uint64_t bytes, const std::string& more) {
    SCOPED_TRACE(fmt::format("a disk of {} bytes {}", bytes, more));
    const std::string root = new_folder("full"), output = root + "/out";
    const std::string command = arguments(output, root + "/cache", more);
    const Outcome outcome = run_abused(command, {{"ROOT", root},
                                                 {"COUNT_FILE", folder_ + "/full_count" + std::to_string(bytes)},
                                                 {"DISK_BYTES", std::to_string(bytes)},
                                                 {"CHILDREN", "1"}});
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_EQ(lines_with(outcome.err, "softreel: ").size(), 1U) << outcome.err;
    const std::string message = outcome.err.substr(std::min(outcome.err.find("softreel: "), outcome.err.size()));
    EXPECT_TRUE(says_disk_is_full(message)) << outcome.err;
    EXPECT_NE(message.find(root + "/"), std::string::npos) << "no file is named: " << outcome.err;
    expect_whole_files(output);
    const Outcome again = run_abused(command, {});
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_TRUE(lines_with(again.err, "damaged").empty()) << again.err;
    expect_equal_final_files(reference_, output);
    EXPECT_EQ(files_under(reference_), files_under(output)) << "a temporary file is left";
  }

  void expect_whole_files(const std::string& output) const {
    for (const std::string& name : final_files(output)) {
      const std::string bytes = read_text(output + "/" + name);
      // The manifest of half the pictures is another than that of all.
      if (name.ends_with("manifest.json"))
        EXPECT_TRUE(nlohmann::json::accept(bytes)) << name;
      else
        EXPECT_TRUE(bytes == read_text(reference_ + "/" + name)) << name;
    }
  }

  std::string folder_, reference_, command_ = "render";
};

TEST_F(DiskFull, IsSaidOnceAndLeavesNoWrongFile) {
  const std::uint64_t bytes = bytes_of_reference();
  std::mt19937_64 random(7);
  // The last twentieth may be the reports, whose length depends on the times in them.
  std::uniform_int_distribution<std::uint64_t> sizes(0, bytes - bytes / 20);
  for (int i = 0; i < 20; ++i) expect_clear_end_and_recovery(sizes(random), "");
}

/// ffmpeg ends with status 0 when it could write all but the end of its file, so its word is not enough.
TEST_F(DiskFull, WhileTheMovieIsEncodedIsSaidToo) {
  const std::string movie = "--set output.movie=true";
  const std::uint64_t bytes = bytes_of_reference(movie), movie_bytes = read_text(reference_ + "/ball.mp4").size();
  ASSERT_GT(movie_bytes, 1000U);
  // Of what is written last (movie, manifest, resolved shot, report), the movie comes first.
  std::uint64_t last = movie_bytes;
  for (const char* name : {"manifest.json", "resolved.toml", "report.json"})
    last += read_text(reference_ + "/ball." + name).size();
  for (int part = 1; part < 8; ++part) expect_clear_end_and_recovery(bytes - last + movie_bytes * part / 8, movie);
}

/// Formats whose header comes first need room twice: for the scratch file, then for the file.
TEST_F(DiskFull, WhileExportingIsSaidAndLeavesNoWrongFile) {
  command_ = "export";
  const std::string formats = "--format glb,usda,mdd";
  const std::uint64_t bytes = bytes_of_reference(formats);
  std::mt19937_64 random(11);
  std::uniform_int_distribution<std::uint64_t> sizes(0, bytes - bytes / 20);
  for (int i = 0; i < 8; ++i) expect_clear_end_and_recovery(sizes(random), formats);
}

TEST_F(DiskFull, OfTheCacheAloneIsSaidOnceAndStopsNothing) {
  bytes_of_reference();
  for (const char* bytes : {"0", "60000", "200000"}) {
    SCOPED_TRACE(bytes);
    const std::string root = new_folder("full_cache"), output = root + "/out", cache = root + "/cache";
    const Outcome outcome = run_abused(arguments(output, cache, ""), {{"ROOT", cache}, {"DISK_BYTES", bytes}});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(lines_with(outcome.err, "warning: ").size(), 1U) << outcome.err;
    EXPECT_TRUE(says_disk_is_full(outcome.err)) << outcome.err;
    EXPECT_NE(outcome.err.find(cache), std::string::npos) << outcome.err;
    expect_equal_final_files(reference_, output);
  }
}

TEST_F(DiskFull, ShortAndInterruptedCallsChangeNothing) {
  bytes_of_reference();
  for (const char* seed : {"1", "2", "3"}) {
    const std::string root = new_folder("short"), output = root + "/out", cache = root + "/cache";
    for (int i = 0; i < 2; ++i) {  // what the first run wrote is read by the second
      const Outcome outcome = run_abused(arguments(output, cache, ""), {{"ROOT", root}, {"SHORT", seed}});
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_EQ(outcome.err, "");
      expect_equal_final_files(reference_, output);
    }
  }
}

}  // namespace
}  // namespace softreel
