#include "tool/batch/job_messages.h"

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(JobMessages, FollowFramesThroughPartsOfLines) {
  JobMessages messages;
  std::string said = "ball: closed, 1 piece\nframes 1/9";
  messages.read(said);
  EXPECT_EQ(messages.total(), 0) << "the line is not whole yet";
  EXPECT_EQ(messages.note(), "ball: closed, 1 piece");
  said += "6  frame 1 traced\n";
  messages.read(said);
  EXPECT_EQ(messages.done(), 1);
  EXPECT_EQ(messages.total(), 96);
  said += "warning: a thing\nframes 40/96  frame 40 traced  3 s left\n";
  messages.read(said);
  EXPECT_EQ(messages.done(), 40);
}

TEST(JobMessages, FindWarningsOnceAndTheMessageAtTheEnd) {
  const std::string said =
      "frames 1/96\nwarning: x.ply: damaged\nwarning: x.ply: damaged\nwarning: another\n\nsoftreel: shot.toml:3: "
      "wrong\n"
      "  Accepted: right.\n";
  EXPECT_EQ(warnings_in(said), (std::vector<std::string>{"x.ply: damaged", "another"}));
  EXPECT_EQ(closing_message(said), "shot.toml:3: wrong\n  Accepted: right.");
}

TEST(JobMessages, WithoutAMessageTheLastLinesStandForIt) {
  EXPECT_EQ(closing_message(""), "");
  EXPECT_EQ(closing_message("one\n"), "one");
  EXPECT_EQ(closing_message("1\n2\n3\n4\n5\n6\n"), "2\n3\n4\n5\n6");
}

}  // namespace
}  // namespace softreel
