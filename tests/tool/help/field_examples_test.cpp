// Every field can be shown by an example that a shot accepts.
#include "tool/help/field_examples.h"

#include "tests/tool/shot/shot_files.h"
#include "tool/help/field_places.h"
#include "tool/shot/shot_layers.h"

namespace softreel {
namespace {

using FieldExamples = ShotFiles;

/// A place of the field in the full shot of the tests, where bodies have names.
std::string place_of(const FieldText& field, const TomlValue& document) {
  const std::vector<FieldPlace> places = field_places(field.path, document);
  for (const FieldPlace& place : places)
    if (place.value != nullptr) return place.path;
  return places.empty() ? "" : places.front().path;
}

/// What a shot would say of the value on its own: problems of other fields that need this one to be something else are
/// none of the example's.
std::string problem_with(const std::string& path, const std::string& value, const TomlValue& full) {
  TomlValue document = full;
  try {
    apply_override(document, {path, value});
    parse_shot("s.toml", document);
  } catch (const Error& error) {
    const std::string said = error.what();
    return said.find(path + " = ") == std::string::npos ? "" : said;
  }
  return "";
}

TEST_F(FieldExamples, AreAcceptedByEveryField) {
  write("s.toml", kFullShot);
  const TomlValue full = load_layers("s.toml", {});
  int tried = 0;
  for (const FieldText& field : field_texts()) {
    const std::string example = field_example(field);
    EXPECT_EQ(example.empty(), field.is_table) << field.path;
    if (field.is_table) continue;
    EXPECT_TRUE(parse_toml_value(example, {}).has_value()) << field.path << " = " << example << " is no TOML";
    const std::string path = place_of(field, full);
    if (path.empty() || path == "use" || path.find("select") != std::string::npos)
      continue;  // use: read before the rest
    EXPECT_EQ(problem_with(path, example, full), "") << example;
    ++tried;
  }
  EXPECT_GT(tried, 120);
}

TEST_F(FieldExamples, ABadValueWouldBeSeen) {
  write("s.toml", kFullShot);
  EXPECT_NE(problem_with("render.samples", "0", load_layers("s.toml", {})), "");
}

}  // namespace
}  // namespace softreel
