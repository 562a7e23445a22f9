// What shells complete after --set: exactly paths that --set takes.
#include <algorithm>

#include "tests/tool/shot/shot_files.h"
#include "tool/help/completion.h"
#include "tool/help/field_examples.h"
#include "tool/shot/shot_layers.h"

namespace softreel {
namespace {

class SettableFields : public ShotFiles {
 protected:
  static bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  }
};

TEST_F(SettableFields, AreTakenBySet) {
  write("s.toml", kFullShot);
  const TomlValue full = load_layers("s.toml", {});
  const std::vector<std::string> fields = settable_fields("s.toml");
  EXPECT_GT(fields.size(), 200u);
  for (const std::string& path : fields) {
    TomlValue document = full;
    EXPECT_NO_THROW(apply_override(document, {path, "1"})) << path;
    EXPECT_NE(find_field(path), nullptr) << path;
  }
}

TEST_F(SettableFields, NameBodiesMaterialsAndPositionsOfTheShot) {
  write("s.toml", kFullShot);
  const std::vector<std::string> fields = settable_fields("s.toml");
  for (const char* path : {"body.first_by_name.tets", "material.gel.density", "light[2].radius",
                           "body.second_by_name.pin[1].select", "render.width"})
    EXPECT_TRUE(has(fields, path)) << path;
  EXPECT_FALSE(has(fields, "light[3].radius"));
  EXPECT_FALSE(has(fields, "body.tets")) << "there are four bodies";
}

TEST_F(SettableFields, OfTheOnlyBodyNeedNoName) {
  write("s.toml", body("tets = 5\n"));
  EXPECT_TRUE(has(settable_fields("s.toml"), "body.tets"));
  EXPECT_TRUE(has(settable_fields(""), "body.tets"));
  EXPECT_TRUE(has(settable_fields("none.toml"), "body.pin[0].select")) << "a shot that cannot be read is as none";
}

TEST_F(SettableFields, HaveTheValuesThatTheyAccept) {
  write("s.toml", kFullShot);
  EXPECT_EQ(field_values("render.auxiliary", ""), (std::vector<std::string>{"true", "false"}));
  EXPECT_TRUE(has(field_values("output.view", ""), "filmic"));
  EXPECT_TRUE(has(field_values("body.first_by_name.material", "s.toml"), "gel"));
  EXPECT_TRUE(field_values("render.samples", "").empty());
  EXPECT_TRUE(field_values("no.such", "").empty());
}

}  // namespace
}  // namespace softreel
