/// kill -9 at any time: no file under a final name is ever wrong, and what was finished is not made again.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <random>
#include <regex>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/base/timer.h"
#include "tests/tool/commands/survival.h"

namespace softreel {
namespace {

using namespace softreel::testing;

constexpr int kKillFrames = 10;
constexpr int kTries = 100, kTriesOfAVariant = 4;

using Pictures = std::map<std::string, std::string>;

/// A shot as its user edits it again and again, with what an undisturbed run makes of it in folders of its own.
struct Variant {
  std::string options;
  std::string reference;
  Pictures pictures;
  std::uint64_t calls = 0;
  double seconds = 0;
  bool has_movie = false;
};

/// Each variant has another light; some another body, some a movie too.
Variant make_variant(const std::string& folder, int number) {
  Variant variant;
  variant.has_movie = number % 3 == 0;
  variant.reference = fmt::format("{}/reference{}", folder, number);
  variant.options =
      fmt::format("--set shot.frames=[1,{}] --set environment.zenith=[0.6,{},0.9]", kKillFrames, 0.2 + number * 0.02);
  if (number % 3 == 1) variant.options += fmt::format(" --set body.ball.pull[0].stiffness={}", 400 + 10 * number);
  if (variant.has_movie) variant.options += " --set output.movie=true";
  const std::string cache = variant.reference + "_cache", count = variant.reference + "_count";
  const auto start = std::chrono::steady_clock::now();
  const Outcome outcome = run_abused(fmt::format("render {}/shot.toml --output {} --cache {} --quiet {}", folder,
                                                 variant.reference, cache, variant.options),
                                     {{"ROOT", variant.reference + ":" + cache}, {"COUNT_FILE", count}});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  variant.seconds = seconds_since(start);
  variant.calls = read_counts(count).calls;
  variant.pictures = pictures_in(variant.reference);
  EXPECT_EQ(variant.pictures.size(), kKillFrames);
  return variant;
}

/// Has said that the first frame is done. From then on nothing of another variant may be left in the frame range.
bool has_shown_progress(const std::string& err) {
  return std::regex_search(err, std::regex(fmt::format("\\b[0-9]+/{}\\b", kKillFrames)));
}

class Kill : public ::testing::Test {
 protected:
  void SetUp() override {
    adopt_orphans();
    folder_ = shot_folder("kill");
    output_ = folder_ + "/out";
  }

  std::string arguments(const Variant& variant) const {
    return fmt::format("render {0}/shot.toml --output {0}/out --cache {0}/cache {1}", folder_, variant.options);
  }

  Outcome killed_after(const Variant& variant, double seconds) {
    RunningProgram program("kill", words_of("softreel " + arguments(variant)));
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    program.signal(SIGKILL);
    return program.wait();
  }

  /// Half of the tries end at a random time, half at a random change of a file. Only the first try of a variant has all
  /// of the work before it: later ones die in the first half of what it took, for they end sooner by themselves.
  Outcome try_to_render(const Variant& variant, int try_of_variant) {
    const double share = try_of_variant == 0 ? 1.0 : 0.5;
    if (try_of_variant % 2 == 0)
      return killed_after(variant, std::uniform_real_distribution(0.0, share * variant.seconds)(random_));
    const auto last =
        std::max<std::uint64_t>(1, static_cast<std::uint64_t>(share * static_cast<double>(variant.calls)));
    const auto call = std::uniform_int_distribution<std::uint64_t>(1, last)(random_);
    return run_abused(arguments(variant),
                      {{"ROOT", output_ + ":" + folder_ + "/cache"}, {"KILL_AT", std::to_string(call)}});
  }

  /// Every picture is whole and of this variant, or, before the first sign of progress, of the one before.
  void expect_sound_pictures(const Variant& variant, const Pictures& before, const std::string& err) const {
    std::vector<std::string> old_names;
    for (const auto& [name, bytes] : pictures_in(output_)) {
      const auto wanted = variant.pictures.find(name);
      ASSERT_NE(wanted, variant.pictures.end()) << name;
      if (bytes == wanted->second) continue;
      const auto old = before.find(name);
      ASSERT_TRUE(old != before.end() && bytes == old->second) << name << " is of no variant, or not whole";
      old_names.push_back(name);
    }
    if (has_shown_progress(err)) {
      EXPECT_EQ(old_names, std::vector<std::string>{}) << "pictures of an older shot are left, after:\n" << err;
    }
  }

  void expect_sound_movie(const Variant& variant) {
    if (variant.has_movie) movies_.insert(read_text(variant.reference + "/ball.mp4"));
    if (!exists(output_ + "/ball.mp4")) return;
    EXPECT_TRUE(movies_.contains(read_text(output_ + "/ball.mp4"))) << "a movie that is not whole, or of no shot";
  }

  /// Without a disturbance the rest is made, and only the rest.
  void finish(const Variant& variant) {
    int survivors = 0;
    for (const auto& [name, bytes] : pictures_in(output_)) survivors += bytes == variant.pictures.at(name) ? 1 : 0;
    const Outcome outcome = run_abused(arguments(variant) + " --quiet --json", {});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(lines_with(outcome.err, "damaged").empty()) << outcome.err;
    const auto report = nlohmann::json::parse(outcome.out);
    EXPECT_LE(report["pictures"]["traced"].get<int>(), kKillFrames - survivors)
        << survivors << " pictures were finished";
    EXPECT_TRUE(pictures_in(output_) == variant.pictures);
  }

  std::string folder_, output_;
  std::mt19937_64 random_{2008};
  std::set<std::string> movies_;
};

TEST_F(Kill, AHundredTimesLeavesNoWrongFile) {
  int killed = 0;
  Pictures before;
  Variant variant;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    if (attempt % kTriesOfAVariant == 0) {
      if (attempt > 0) finish(variant);
      before = variant.pictures;
      variant = make_variant(folder_, attempt / kTriesOfAVariant);
    }
    SCOPED_TRACE(fmt::format("try {}: {}", attempt, variant.options));
    const Outcome outcome = try_to_render(variant, attempt % kTriesOfAVariant);
    ASSERT_TRUE(outcome.status == 0 || outcome.status == 128 + SIGKILL) << outcome.status << outcome.err;
    killed += outcome.status == 0 ? 0 : 1;
    expect_sound_pictures(variant, before, outcome.err);
    expect_sound_movie(variant);
  }
  fmt::print("[ MEASURED ] {} of {} tries were killed\n", killed, kTries);
  EXPECT_GE(killed, kTries / 3) << "too few tries were killed to test anything";
  finish(variant);
  // The encoders of killed runs end by themselves; only then can be seen what they left.
  EXPECT_TRUE(wait_for_orphans());
  ASSERT_TRUE(variant.has_movie);
  finish(variant);
  expect_equal_final_files(variant.reference, output_);
  EXPECT_EQ(files_under(variant.reference), files_under(output_)) << "a temporary file is left";
}

/// Not at random: with three frames every change of a file can have its own death.
TEST_F(Kill, AtEveryChangeOfAFileLeavesNoWrongFile) {
  const std::string root = folder_ + "/reference", reference = root + "/out", count = folder_ + "/count";
  const auto in = [&](const std::string& folder) {
    return fmt::format("render {0}/shot.toml --quiet --json --set shot.frames=[1,3] --output {1}/out --cache {1}/cache",
                       folder_, folder);
  };
  ASSERT_EQ(run_abused(in(root), {{"ROOT", root}, {"COUNT_FILE", count}}).status, 0);
  const Pictures wanted = pictures_in(reference);
  const std::uint64_t calls = read_counts(count).calls;
  ASSERT_GT(calls, 20U);
  for (std::uint64_t call = 1; call <= calls; ++call) {
    SCOPED_TRACE(fmt::format("killed at change {} of {}", call, calls));
    const std::string work = new_folder("kill_every"), output = work + "/out";
    const int status = run_abused(in(work), {{"ROOT", work}, {"KILL_AT", std::to_string(call)}}).status;
    // Threads that share the work may take a call less than the run that counted.
    ASSERT_TRUE(status == 128 + SIGKILL || (status == 0 && call > calls / 2)) << status;
    const Pictures survivors = pictures_in(output);
    for (const auto& [name, bytes] : survivors) EXPECT_TRUE(bytes == wanted.at(name)) << name;
    const Outcome outcome = run_abused(in(work), {});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    const auto report = nlohmann::json::parse(outcome.out);
    EXPECT_LE(report["pictures"]["traced"].get<std::size_t>(), wanted.size() - survivors.size());
    expect_equal_final_files(reference, output);
    EXPECT_EQ(files_under(reference), files_under(output)) << "a temporary file is left";
  }
}

/// Files that grow sample by sample, and their scratch files, have no name before they are whole.
TEST_F(Kill, WhileExportingLeavesNoWrongFileAndNoScratch) {
  const std::string cache = folder_ + "/cache", reference = folder_ + "/reference", count = folder_ + "/count";
  const auto to = [&](const std::string& output) {
    return fmt::format("export {}/shot.toml --quiet --format glb,usda,mdd --output {} --cache {}", folder_, output,
                       cache);
  };
  ASSERT_EQ(run_abused(to(folder_ + "/first"), {}).status, 0);  // fills the cache
  ASSERT_EQ(run_abused(to(reference), {{"ROOT", reference}, {"COUNT_FILE", count}}).status, 0);
  const std::uint64_t calls = read_counts(count).calls;
  ASSERT_GT(calls, 20U);
  for (std::uint64_t call = 1; call <= calls; call += std::max<std::uint64_t>(1, calls / 25)) {
    SCOPED_TRACE(fmt::format("killed at change {} of {}", call, calls));
    const std::string output = new_folder("kill_export");
    EXPECT_EQ(run_abused(to(output), {{"ROOT", output}, {"KILL_AT", std::to_string(call)}}).status, 128 + SIGKILL);
    for (const char* name : {"ball.ball.glb", "ball.usda", "ball.ball.mdd"})
      if (exists(output + "/" + name)) {
        EXPECT_TRUE(read_text(output + "/" + name) == read_text(reference + "/" + name)) << name;
      }
    EXPECT_EQ(run_abused(to(output), {}).status, 0);
    expect_equal_final_files(reference, output);
    EXPECT_EQ(files_under(reference), files_under(output)) << "a temporary file is left";
  }
}

}  // namespace
}  // namespace softreel
