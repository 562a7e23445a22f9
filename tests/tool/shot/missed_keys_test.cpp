/// Which keys are said to lie before the shot.
#include "tool/shot/missed_keys.h"

#include <gtest/gtest.h>

namespace softreel {
namespace {

Track<double> keyed(double from, double to, double value = 2) {
  return {{{from, 1, Ease::Linear}, {to, value, Ease::Linear}}};
}

/// Frames 1001 to 1012.
Shot shot_from_1001() {
  Shot shot;
  shot.path = "a.toml";
  shot.settings.first_frame = 1001;
  shot.settings.last_frame = 1012;
  return shot;
}

std::vector<std::string> said_of_focus(const Track<double>& track) {
  Shot shot = shot_from_1001();
  shot.camera.focus_distance = track;
  return find_missed_keys(shot);
}

TEST(MissedKeys, AreThoseBeforeTheShot) {
  EXPECT_EQ(said_of_focus(keyed(1, 12)),
            std::vector<std::string>{"a.toml: camera.focus_distance stands still: its keys, frames 1 to 12, lie before "
                                     "the shot's, 1001 to 1012."});
}

TEST(MissedKeys, AreNoneWhereTheShotMeetsThemOrTheyMoveNothing) {
  EXPECT_TRUE(said_of_focus(keyed(1, 1001)).empty());
  EXPECT_TRUE(said_of_focus(keyed(1, 2000)).empty());
  EXPECT_TRUE(said_of_focus(keyed(1013, 1020)).empty()) << "it may be cut short";
  EXPECT_TRUE(said_of_focus(keyed(1, 12, 1)).empty()) << "both keys are one value";
  EXPECT_TRUE(said_of_focus(constant_track(3.0)).empty());
}

TEST(MissedKeys, AreFoundInEveryTable) {
  Shot shot = shot_from_1001();
  Transform away;
  away.translate = Vec3(1, 0, 0);
  BodySettings& body = shot.bodies.emplace_back();
  body.name = "ball";
  body.pins.emplace_back().keys = {{{1, {}, Ease::Linear}, {12, away, Ease::Linear}}};
  body.pulls.emplace_back().stiffness = keyed(1, 12);
  shot.glues.emplace_back().stiffness = keyed(1, 12);
  shot.lights.emplace_back().power = keyed(1, 12);
  shot.sky.emplace().turbidity = keyed(1, 12);
  shot.environment_strength = keyed(1, 12);
  AppearanceTrack& track = shot.materials["wax"].tracks.emplace_back();
  track.field = "roughness";
  track.numbers = keyed(1, 12);
  std::string all;
  for (const std::string& line : find_missed_keys(shot)) all += line;
  for (const char* field :
       {"body.ball.pin[0].keys", "body.ball.pull[0].stiffness", "glue[0].stiffness", "light[0].power",
        "environment.sky.turbidity", "environment.strength", "material.wax.roughness"})
    EXPECT_NE(all.find(std::string(" ") + field + " stands still"), std::string::npos) << field;
}

TEST(MissedKeys, OfASimulationBeginWithThePreroll) {
  Shot shot = shot_from_1001();
  shot.settings.preroll = 5;
  shot.bodies.emplace_back().pulls.emplace_back().stiffness = keyed(990, 996);
  EXPECT_TRUE(find_missed_keys(shot).empty());
  shot.camera.focus_distance = keyed(990, 996);
  EXPECT_EQ(find_missed_keys(shot).size(), 1U);
}

}  // namespace
}  // namespace softreel
