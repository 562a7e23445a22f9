#include "tool/shot/shot_layers.h"

#include "tests/tool/shot/shot_files.h"
#include "tool/shot/keyed_look.h"

namespace softreel {
namespace {

using UsePresets = ShotFiles;

TEST_F(UsePresets, PutsTheShotsOwnValuesOverThem) {
  write("presets/gel.toml", "[material.gel]\ndensity = 900\nroughness = 0.1\n");
  const Shot shot = load("use = [\"presets/gel.toml\"]\n" + body("[material.gel]\ndensity = 950\n"));
  EXPECT_EQ(shot.materials.at("gel").physics.density, 950);
  EXPECT_EQ(shot.materials.at("gel").appearance.roughness, 0.1f);
}

TEST_F(UsePresets, LetsLaterOnesWinAndTakesASingleName) {
  write("one.toml", "[render]\nsamples = 1\nwidth = 10\n");
  write("two.toml", "[render]\nsamples = 2\n");
  const Shot shot = load("use = [\"one.toml\", \"two.toml\"]\n" + body(""));
  EXPECT_EQ(shot.render.params.samples, 2);
  EXPECT_EQ(shot.render.params.width, 10);
  EXPECT_EQ(load("use = \"one.toml\"\n" + body("")).render.params.samples, 1);
}

TEST_F(UsePresets, FollowsPathsRelativeToTheFileThatSaysThem) {
  write("presets/a/one.toml", "use = [\"../b/two.toml\"]\n[render]\nwidth = 10\n");
  write("presets/b/two.toml", "[render]\nwidth = 20\nheight = 20\n[environment]\nimage = \"sky.exr\"\n");
  const Shot shot = load("use = [\"presets/a/one.toml\"]\n" + body(""));
  EXPECT_EQ(shot.render.params.width, 10);
  EXPECT_EQ(shot.render.params.height, 20);
  EXPECT_EQ(shot.environment_image, "presets/b/sky.exr");
}

TEST_F(UsePresets, ReplacesListsAsAWhole) {
  write("lights.toml", "[[light]]\ntype = \"sun\"\n[[light]]\ntype = \"sun\"\n[camera]\nshift = [1, 2, 3]\n");
  EXPECT_EQ(load("use = [\"lights.toml\"]\n" + body("")).lights.size(), 2u);
  const Shot shot = load("use = [\"lights.toml\"]\n" + body("[[light]]\ntype = \"area\"\n"));
  EXPECT_EQ(lights_at(shot, 1).suns.size(), 0u);
  EXPECT_EQ(lights_at(shot, 1).lamps.size(), 1u);
  EXPECT_EQ(shot.camera.shift, Vec3(1, 2, 3));
}

TEST_F(UsePresets, ReplacesTheAlternativeOfALowerLayer) {
  write("fine.toml", "[body.a]\nedge = 0.01\nfit = 2\n");
  const Shot shot = load("use = [\"fine.toml\"]\n" + body("tets = 500\n"));
  EXPECT_EQ(shot.bodies[0].edge, 0);
  EXPECT_EQ(shot.bodies[0].tets, 500);
  EXPECT_EQ(shot.bodies[0].fit, 2);
}

TEST_F(UsePresets, ASwitchThatIsOffIsNoAlternative) {
  EXPECT_EQ(message(body("[material.skin]\nbase_color = [0.8, 0.1, 0.1]\nvertex_colors = false\n")), "");
  write("red.toml", "[material.skin]\nbase_color = [0.8, 0.1, 0.1]\n");
  write("painted.toml", "[material.skin]\nvertex_colors = true\n");
  const auto colour = [&](const std::string& text, const std::vector<std::string>& sets) {
    return load(text, sets).materials.at("skin").appearance.base_color;
  };
  const std::string red = "use = [\"red.toml\"]\n" + body("");
  EXPECT_EQ(colour(red + "[material.skin]\nvertex_colors = false\n", {}), Vec3f(0.8f, 0.1f, 0.1f));
  EXPECT_EQ(colour(red, {"material.skin.vertex_colors=false"}), Vec3f(0.8f, 0.1f, 0.1f));
  EXPECT_EQ(
      colour("use = [\"painted.toml\"]\n" + body("[material.skin]\nvertex_colors = false\nbase_color = [0, 1, 0]\n"),
             {}),
      Vec3f(0, 1, 0));
}

TEST_F(UsePresets, KeepsThePlaceOfEachValue) {
  write("presets/gel.toml", "[material.gel]\npoisson_ratio = 0.5\n");
  const std::string text = message("use = [\"presets/gel.toml\"]\n" + body("[material.gel]\ndensity = 0\n"));
  EXPECT_NE(text.find("presets/gel.toml:2:17: material.gel.poisson_ratio = 0.5"), std::string::npos) << text;
  EXPECT_NE(text.find("s.toml:5:11: material.gel.density = 0"), std::string::npos) << text;
}

TEST_F(UsePresets, RefusesCircles) {
  write("a.toml", "use = [\"sub/b.toml\"]\n");
  write("sub/b.toml", "use = [\"../a.toml\"]\n");
  const std::string text = message("use = [\"a.toml\"]\n" + body(""));
  EXPECT_NE(text.find("sub/b.toml:1:8: use = \"a.toml\""), std::string::npos) << text;
  EXPECT_NE(text.find("a.toml uses sub/b.toml uses a.toml"), std::string::npos) << text;
  EXPECT_NE(message("use = [\"s.toml\"]\n" + body("")).find("circle"), std::string::npos);
}

TEST_F(UsePresets, AllowsOneFileFromTwoSides) {
  write("base.toml", "[render]\nwidth = 10\n");
  write("a.toml", "use = [\"base.toml\"]\n");
  write("b.toml", "use = [\"base.toml\"]\n");
  EXPECT_EQ(load("use = [\"a.toml\", \"b.toml\"]\n" + body("")).render.params.width, 10);
}

TEST_F(UsePresets, SaysWhoNamesAMissingFile) {
  const std::string text = message("use = [\n  \"gone.toml\" ]\n" + body(""));
  EXPECT_NE(text.find("s.toml:2:3: use = \"gone.toml\" is wrong because this file does not exist"), std::string::npos)
      << text;
  EXPECT_NE(message("use = 3\n" + body("")).find("s.toml:1:7: use = 3"), std::string::npos);
  EXPECT_NE(message("use = [3]\n" + body("")).find("it holds no path"), std::string::npos);
}

TEST_F(UsePresets, RefusesAPresetOfANewerProgramThoughTheShotIsNot) {
  write("new.toml", "schema = 9\n");
  const std::string text = message("schema = 1\nuse = [\"new.toml\"]\n" + body(""));
  EXPECT_NE(text.find("new.toml:1:10: schema = 9"), std::string::npos) << text;
}

}  // namespace
}  // namespace softreel
