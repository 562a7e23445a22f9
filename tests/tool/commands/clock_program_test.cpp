/// Clocks that jump and files with impossible dates: what is done is known by its contents.
#include <array>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/tool/commands/survival.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

constexpr int kClockFrames = 8;

/// Runs under a clock that jumps by years, or an honest one without a seed.
json render_by_clock(const std::string& folder, const std::string& output, const std::string& clock_seed) {
  const Abuse abuse = clock_seed.empty() ? Abuse() : Abuse{{"CLOCK", clock_seed}};
  const Outcome outcome =
      run_abused(fmt::format("render {}/shot.toml --output {} --quiet --json --set shot.frames=[1,{}] "
                             "--set output.movie=true",
                             folder, output, kClockFrames),
                 abuse);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  return json::parse(outcome.out);
}

void expect_nothing_made(const json& report) {
  EXPECT_EQ(report["pictures"]["traced"], 0);
  EXPECT_EQ(report["pictures"]["kept"], kClockFrames);
  EXPECT_EQ(report["simulation"]["computed"], 0);
  EXPECT_TRUE(report["bodies"][0].value("tets_from_cache", true));
}

/// Sets the dates of all files and folders; 4102444800 is the year 2100.
void set_dates(const std::string& folder, time_t seconds) {
  const std::array<timespec, 2> dates{{{seconds, 0}, {seconds, 0}}};
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    ASSERT_EQ(::utimensat(AT_FDCWD, entry.path().c_str(), dates.data(), 0), 0) << entry.path();
}

TEST(Clock, ThatJumpsByYearsChangesNothing) {
  const std::string folder = shot_folder("clock");
  render_by_clock(folder, folder + "/reference", "");
  const json report = render_by_clock(folder, folder + "/out", "5");
  EXPECT_EQ(report["pictures"]["traced"], kClockFrames);
  EXPECT_LT(report["seconds"].get<double>(), 600) << "the report measures by the monotonic clock";
  expect_equal_final_files(folder + "/reference", folder + "/out");
  for (const char* seed : {"6", "7", "8"}) expect_nothing_made(render_by_clock(folder, folder + "/out", seed));
  expect_equal_final_files(folder + "/reference", folder + "/out");
}

TEST(Clock, DatesOfFilesMeanNothing) {
  const std::string folder = shot_folder("dates");
  render_by_clock(folder, folder + "/reference", "");
  render_by_clock(folder, folder + "/out", "");
  for (const time_t seconds : {time_t{0}, time_t{4102444800}, time_t{1}}) {
    set_dates(folder + "/out", seconds);
    expect_nothing_made(render_by_clock(folder, folder + "/out", ""));
    expect_equal_final_files(folder + "/reference", folder + "/out");
  }
}

TEST(Clock, ANewerMeshWithTheSameBytesIsTheSame) {
  const std::string folder = shot_folder("newer");
  render_by_clock(folder, folder + "/out", "");
  write_text(folder + "/sphere.obj", read_text(folder + "/sphere.obj"));
  expect_nothing_made(render_by_clock(folder, folder + "/out", ""));
}

TEST(Clock, AnOlderMeshWithOtherBytesIsAnother) {
  const std::string folder = shot_folder("older");
  const json first = render_by_clock(folder, folder + "/out", "");
  write_text(folder + "/sphere.obj", sphere_obj(14));
  set_dates(folder, 1);
  const json report = render_by_clock(folder, folder + "/out", "");
  EXPECT_EQ(report["simulation"]["loaded"], 0);
  EXPECT_EQ(report["pictures"]["kept"], 0);
}

}  // namespace
}  // namespace softreel
