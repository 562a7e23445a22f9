/// The weapons of the abuse library hit: a test under abuse that passes has not been spared.
#include <csignal>
#include <limits>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/abused_program.h"

namespace softreel {
namespace {

using namespace softreel::testing;

std::string folder_with_old() {
  const std::string folder = new_folder("probe");
  write_text(folder + "/old", std::string(100, 'o'));
  return folder;
}

Outcome probe(const std::string& action, const std::string& folder, const Abuse& abuse) {
  return RunningProgram("probe", {SOFTREEL_ABUSE_PROBE, action, folder}, abuse).wait();
}

/// What is in a folder: names and sizes.
std::string listing(const std::string& folder) {
  std::string text;
  for (const std::string& name : files_under(folder))
    text += fmt::format("{} {}\n", name, read_text(folder + "/" + name).size());
  return text;
}

/// An action, and how many of its calls change something.
struct Change {
  const char* action;
  int calls;
};

void PrintTo(const Change& change, std::ostream* out) {
  *out << change.action;
}

class EveryChange : public ::testing::TestWithParam<Change> {};

TEST_P(EveryChange, IsDoneWithoutAbuse) {
  const Outcome outcome = probe(GetParam().action, folder_with_old(), {});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
}

TEST_P(EveryChange, IsCountedAndKilled) {
  const std::string count = new_folder("count") + "/count", folder = folder_with_old();
  EXPECT_EQ(probe(GetParam().action, folder, {{"ROOT", folder}, {"COUNT_FILE", count}}).status, 0);
  EXPECT_EQ(read_counts(count).calls, GetParam().calls);
  for (int call = 1; call <= GetParam().calls; ++call) {
    const std::string other = folder_with_old();
    const Abuse abuse = {{"ROOT", other}, {"KILL_AT", std::to_string(call)}};
    EXPECT_EQ(probe(GetParam().action, other, abuse).status, 128 + SIGKILL) << "call " << call;
    if (call == 1) {
      EXPECT_EQ(listing(other), "old 100\n");
    }
  }
  EXPECT_EQ(probe(GetParam().action, folder_with_old(), {{"ROOT", folder + "else"}, {"KILL_AT", "1"}}).status, 0);
}

TEST_P(EveryChange, IsRefusedWhereOneMayOnlyRead) {
  const std::string folder = folder_with_old();
  const Outcome outcome = probe(GetParam().action, folder, {{"READ_ONLY", "/none:" + folder}});
  EXPECT_EQ(outcome.out, "EROFS\n");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(listing(folder), "old 100\n");
}

INSTANTIATE_TEST_SUITE_P(Abuse, EveryChange,
                         ::testing::Values(Change{"ofstream", 2}, Change{"stdio", 3}, Change{"write", 2},
                                           Change{"writev", 2}, Change{"tmpfile", 3}, Change{"copy_file_range", 3},
                                           Change{"sendfile", 3}, Change{"rename", 1}, Change{"renameat", 1},
                                           Change{"link", 1}, Change{"unlink", 1}, Change{"remove", 1},
                                           Change{"mkdir", 1}, Change{"truncate", 1}),
                         [](const auto& change) { return std::string(change.param.action); });

TEST(Abuse, AFullDiskTakesNoByteMoreThanItHas) {
  for (const char* action : {"ofstream", "stdio", "write", "writev"}) {
    const std::string folder = folder_with_old();
    const Abuse abuse = {{"ROOT", folder}, {"DISK_BYTES", "300"}};
    EXPECT_EQ(probe(action, folder, abuse).out, "ENOSPC\n") << action;
    EXPECT_EQ(listing(folder), "new 300\nold 100\n") << action;
  }
  for (const char* action : {"copy_file_range", "sendfile"}) {
    const std::string folder = folder_with_old();
    EXPECT_EQ(probe(action, folder, {{"ROOT", folder}, {"DISK_BYTES", "30"}}).out, "ENOSPC\n") << action;
    EXPECT_EQ(listing(folder), "new 30\nold 100\n") << action;
    EXPECT_EQ(probe(action, folder_with_old(), {{"ROOT", folder}, {"DISK_BYTES", "100"}}).out, "done\n") << action;
  }
}

TEST(Abuse, AKilledWriteIsHalfDone) {
  const std::string folder = folder_with_old();
  EXPECT_EQ(probe("write", folder, {{"ROOT", folder}, {"KILL_AT", "2"}}).status, 128 + SIGKILL);
  EXPECT_EQ(listing(folder), "new 500\nold 100\n");
}

TEST(Abuse, ShortReadsAndWritesTakeManyCallsAndMoveAllBytes) {
  for (const char* action : {"write", "writev"}) {
    const std::string count = new_folder("count") + "/count", folder = folder_with_old();
    const Outcome outcome = probe(action, folder, {{"ROOT", folder}, {"SHORT", "7"}, {"COUNT_FILE", count}});
    EXPECT_EQ(outcome.out, "done\n");
    EXPECT_GT(read_counts(count).calls, 3U) << action;
    EXPECT_EQ(read_counts(count).bytes, 1000U) << action;
    EXPECT_EQ(listing(folder), "new 1000\nold 100\n");
  }
}

TEST(Abuse, TheTimeOfDayJumpsAndTheMonotonicClockDoesNot) {
  std::istringstream lines(probe("clock", "", {{"CLOCK", "3"}}).out);
  long day[3] = {}, last[3] = {}, steady = 0, steady_last = 0;
  int count = 0;
  constexpr long kYear = 365L * 24 * 3600;
  long low = std::numeric_limits<long>::max(), high = 0;
  for (; lines >> day[0] >> day[1] >> day[2] >> steady; ++count) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NE(day[k], last[k]);
      low = std::min(low, day[k]);
      high = std::max(high, day[k]);
      last[k] = day[k];
    }
    if (steady_last == 0) steady_last = steady;
    EXPECT_GE(steady, steady_last);
    EXPECT_LE(steady - steady_last, 60) << "honest";
    steady_last = steady;
  }
  EXPECT_EQ(count, 20);
  EXPECT_GT(high - low, 10 * kYear);
  EXPECT_LE(high - low, 20 * kYear + 60);
}

}  // namespace
}  // namespace softreel
