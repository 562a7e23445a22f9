// What `softreel explain` says: of a field by whichever name, and of its value by the layer that it comes from.
#include "tool/help/field_explanation.h"

#include <algorithm>

#include "tests/tool/shot/shot_files.h"

namespace softreel {
namespace {

class FieldExplanations : public ShotFiles {
 protected:
  static std::string failure(const std::string& path) {
    try {
      explain(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      return error.what();
    }
    return "";
  }
  static bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  }
  /// The values of a field in s.toml, which uses materials/soft.toml.
  static std::vector<FieldValue> values(const std::string& path, const std::vector<std::string>& sets = {}) {
    write("presets/soft.toml", "[material.soft]\nyoungs_modulus = 2e4\n\n[render]\nsamples = 4\n");
    write("s.toml",
          "use = [\"presets/soft.toml\"]\n"
          "[body.a]\nmesh = \"a.ply\"\ntets = 700\nmaterial = \"soft\"\n"
          "[[body.a.pin]]\nselect = { all = true }\n"
          "[body.b]\nmesh = \"b.ply\"\nmaterial = \"soft\"\n"
          "[render]\nwidth = 64\n");
    return field_values_in(path, explain(path).text, "s.toml", overrides(sets));
  }
};

TEST_F(FieldExplanations, FindTheFieldByEveryNameThatAShotMayUse) {
  for (const char* path : {"body.*.tets", "body.tets", "body.creature.tets", "tets"})
    EXPECT_EQ(explain(path).text.path, "body.*.tets") << path;
  EXPECT_EQ(explain("body.creature.pin[3].select").text.path, "body.*.pin[].select");
  EXPECT_EQ(explain("max_bounces").text.path, "render.max_bounces");
}

TEST_F(FieldExplanations, SayAllThatActsOnABodyWhichStartsInBalance) {
  const std::string sentence = explain("shot.start").text.sentence;
  for (const char* what : {"gravity", "pins", "pulls", "glue"})
    EXPECT_NE(sentence.find(what), std::string::npos) << what << "\n" << sentence;
}

TEST_F(FieldExplanations, NameTheNearestOfAnUnknownField) {
  EXPECT_NE(failure("render.sampels").find("render.samples"), std::string::npos) << failure("render.sampels");
  EXPECT_NE(failure("max_bounce").find("max_bounces"), std::string::npos) << failure("max_bounce");
  EXPECT_NE(failure("lights.power").find("light[].power"), std::string::npos) << failure("lights.power");
}

TEST_F(FieldExplanations, NameAllFieldsOfAnAmbiguousName) {
  const std::string said = failure("stiffness");
  EXPECT_NE(said.find("body.*.pull[].stiffness"), std::string::npos) << said;
  EXPECT_NE(said.find("body.*.region[].stiffness"), std::string::npos) << said;
}

TEST_F(FieldExplanations, NameWhatExcludesAFieldAndWhatSpeaksOfIt) {
  const FieldExplanation tets = explain("body.*.tets");
  EXPECT_TRUE(has(tets.instead, "body.*.edge"));
  EXPECT_TRUE(has(tets.related, "body.*.graded"));
  EXPECT_FALSE(has(tets.related, "body.*.edge")) << "named twice";
  EXPECT_TRUE(has(explain("render.noise").related, "render.min_samples"));
  EXPECT_TRUE(has(explain("camera").inner, "margin"));
}

TEST_F(FieldExplanations, TellTheLayerOfEveryValue) {
  const std::vector<FieldValue> tets = values("body.*.tets");
  ASSERT_EQ(tets.size(), 2u);
  EXPECT_EQ(tets[0].path, "body.a.tets");
  EXPECT_EQ(tets[0].value, "700");
  EXPECT_TRUE(tets[0].where.starts_with("s.toml:4:")) << tets[0].where;
  EXPECT_EQ(tets[0].layer, "the shot itself");
  EXPECT_EQ(tets[1].path, "body.b.tets");
  EXPECT_EQ(tets[1].layer, "default");
  const std::vector<FieldValue> samples = values("render.samples");
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_TRUE(samples[0].where.starts_with("presets/soft.toml:5:")) << samples[0].where;
  EXPECT_EQ(samples[0].layer, "a preset that it uses");
  const std::vector<FieldValue> set = values("render.samples", {"render.samples=2"});
  EXPECT_EQ(set.at(0).value, "2");
  EXPECT_EQ(set.at(0).layer, "--set");
}

TEST_F(FieldExplanations, KeepToThePlaceThatIsNamed) {
  const std::vector<FieldValue> one = values("body.b.tets");
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].path, "body.b.tets");
  EXPECT_TRUE(values("light[].power").empty()) << "the shot has no light";
  EXPECT_EQ(values("body.tets").size(), 2U) << "of all bodies";
  EXPECT_EQ(values("body.a.pin[0].active").size(), 1U);
  EXPECT_EQ(values("tets").size(), 2U);
}

TEST_F(FieldExplanations, RefusePlacesThatTheShotDoesNotHave) {
  for (const auto& [path, missing] :
       {std::pair("body.nobody.tets", "s.toml has no body.nobody"), std::pair("light[0].power", "has no light[0]"),
        std::pair("body.a.pin[7].active", "has no body.a.pin[7]"),
        std::pair("body.b.pin[0].active", "has no body.b.pin[0]"),
        std::pair("material.hard.youngs_modulus", "has no material.hard")}) {
    try {
      values(path);
      ADD_FAILURE() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      EXPECT_NE(std::string(error.what()).find(missing), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace softreel
