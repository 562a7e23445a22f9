/// Which ranges of frames are said to hold nothing.
#include "tool/bodies/held_ranges.h"

#include <gtest/gtest.h>

namespace softreel {
namespace {

Shot dynamic_shot(int substeps) {
  Shot shot;
  shot.settings.first_frame = 1;
  shot.settings.last_frame = 24;
  shot.solver.substeps = substeps;
  return shot;
}

std::string said(const Shot& shot, const std::vector<FrameRange>& active, bool grab = false) {
  std::string all;
  for (const std::string& line : find_missed_ranges(shot, "body.b.pull[0] (a.toml:9)", active, grab))
    all += line + "\n";
  return all;
}

TEST(HeldRanges, NameARangeBetweenTheEndsOfSteps) {
  const std::string line = said(dynamic_shot(1), {{1, 2}, {3.2, 3.8}});
  for (const char* part : {"body.b.pull[0] (a.toml:9)", "active = [3.2, 3.8]", "no step of time ends in it"})
    EXPECT_NE(line.find(part), std::string::npos) << line;
  EXPECT_EQ(line.find("[1, 2]"), std::string::npos) << line;
  EXPECT_EQ(said(dynamic_shot(2), {{3.2, 3.8}}), "") << "there is one at 3.5";
  EXPECT_EQ(said(dynamic_shot(5), {{3.2, 3.2}}), "");
  Shot controlled = dynamic_shot(1);
  controlled.solver.step_error = 1e-4;
  EXPECT_EQ(said(controlled, {{3.2, 3.8}}), "") << "steps may end there";
}

TEST(HeldRanges, AreOfSimulatedFramesOnly) {
  EXPECT_EQ(said(dynamic_shot(1), {{0.2, 0.8}, {2, 3}, {24.2, 24.8}}), "");
  EXPECT_NE(said(dynamic_shot(1), {{0.2, 0.8}, {30, 40}}).find("out of the simulated frames, 1 to 24"),
            std::string::npos);
  Shot preroll = dynamic_shot(1);
  preroll.settings.preroll = 10;
  EXPECT_NE(said(preroll, {{0.2, 0.8}}), "");
}

TEST(HeldRanges, NameAGrabThatLetsGoBeforeTheNextStep) {
  for (const int substeps : {1, 8}) {
    const std::string line = said(dynamic_shot(substeps), {{3, 3}}, true);
    EXPECT_NE(line.find("active = [3, 3] grabs but never holds"), std::string::npos) << line;
    EXPECT_EQ(said(dynamic_shot(substeps), {{3, 4}}, true), "");
    EXPECT_EQ(said(dynamic_shot(substeps), {{3, 3}, {4, 9}}, true), "") << "it is held on into the next";
    EXPECT_EQ(said(dynamic_shot(substeps), {{3, 3}}, false), "");
  }
  EXPECT_NE(said(dynamic_shot(1), {{1, 1}}, true), "");
}

TEST(HeldRanges, OfAnEquilibriumHoldAtItsFrame) {
  Shot still = dynamic_shot(1);
  still.settings.mode = SimulationMode::Static;
  EXPECT_EQ(said(still, {{3, 3}}, true), "");
  EXPECT_NE(said(still, {{3.2, 3.8}}), "");
  Shot sagged = dynamic_shot(1);
  sagged.settings.start = StartState::Equilibrium;
  EXPECT_EQ(said(sagged, {{1, 1}}, true), "");
  EXPECT_NE(said(sagged, {{2, 2}}, true), "");
}

}  // namespace
}  // namespace softreel
