#include "tests/tool/shot/shot_files.h"
#include "tool/shot/keyed_look.h"
#include "tool/shot/shot_load.h"

namespace softreel {
namespace {

using WriteShot = ShotFiles;

Shot reload(const Shot& shot) {
  std::filesystem::create_directories("elsewhere");
  std::ofstream("elsewhere/again.toml") << to_toml(shot);
  return load_shot("elsewhere/again.toml", {});
}

TEST_F(WriteShot, LoadsAsTheSameShotFromAnotherFolder) {
  const Shot shot = load(kFullShot);
  const Shot again = reload(shot);
  EXPECT_EQ(to_toml(again), to_toml(shot));
  EXPECT_EQ(again.settings.name, "other");
  EXPECT_EQ(again.bodies[0].mesh, std::filesystem::absolute("meshes/b.ply").string());
}

TEST_F(WriteShot, KeepsEveryBitOfConvertedValues) {
  const Shot shot = load(kFullShot), again = reload(shot);
  const auto& keys = shot.bodies[0].pins[0].keys.keys;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    EXPECT_EQ(again.bodies[0].pins[0].keys.keys[i].value.rotate, keys[i].value.rotate);
    EXPECT_EQ(again.bodies[0].pins[0].keys.keys[i].value.pivot, keys[i].value.pivot);
    EXPECT_EQ(again.bodies[0].pins[0].keys.keys[i].ease, keys[i].ease);
  }
  EXPECT_EQ(environment_at(again, 1).rotation, environment_at(shot, 1).rotation);
  EXPECT_EQ(lights_at(again, 1).lamps[0].u, lights_at(shot, 1).lamps[0].u);
  EXPECT_EQ(lights_at(again, 1).lamps[0].v, lights_at(shot, 1).lamps[0].v);
  EXPECT_EQ(lights_at(again, 1).lamps[0].radiance, lights_at(shot, 1).lamps[0].radiance);
  EXPECT_EQ(lights_at(again, 1).suns[0].direction, lights_at(shot, 1).suns[0].direction);
  EXPECT_EQ(again.materials.at("rubber").appearance.base_color, shot.materials.at("rubber").appearance.base_color);
}

TEST_F(WriteShot, WritesDefaultsOutToo) {
  const Shot shot = load(body("[[body.a.pin]]\nselect = { all = true }\n"));
  const std::string text = to_toml(shot);
  EXPECT_NE(text.find("[material.default]"), std::string::npos);
  EXPECT_NE(text.find("youngs_modulus = 100000"), std::string::npos);
  EXPECT_EQ(to_toml(reload(shot)), text);
}

TEST_F(WriteShot, KeepsAwkwardNumbersAndText) {
  const Shot shot = load(
      "[body.\"odd name é\"]\nmesh = \"q\\\"\\\\\\t\\u0001.ply\"\ntranslate = [-0.0, 1e300, 5e-324]\n"
      "rotate_deg = [0.1, 123456789012345678, 1e-7]\n[[body.\"odd name é\".pin]]\nselect = { all = "
      "true }\nkeys = [{ frame = 0.1, rotate_deg = [1e-310, 1.7e308, 0.3333333333333333] }]\n");
  const Shot again = reload(shot);
  EXPECT_EQ(again.bodies[0].name, shot.bodies[0].name);
  EXPECT_EQ(again.bodies[0].mesh, std::filesystem::absolute(shot.bodies[0].mesh).string());
  EXPECT_EQ(again.bodies[0].translate, shot.bodies[0].translate);
  EXPECT_TRUE(std::signbit(again.bodies[0].translate.x()));
  EXPECT_EQ(again.bodies[0].rotate_deg, shot.bodies[0].rotate_deg);
  EXPECT_EQ(again.bodies[0].pins[0].keys.keys[0].value.rotate, shot.bodies[0].pins[0].keys.keys[0].value.rotate);
}

TEST_F(WriteShot, PrintsNumbersInTheFewestDigits) {
  const std::string text = to_toml(load(body("[material.m]\nroughness = 0.1\n[environment]\nrotation_deg = 77.7\n")));
  EXPECT_NE(text.find("roughness = 0.1\n"), std::string::npos) << text;
  EXPECT_NE(text.find("rotation_deg = 77.7\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace softreel
