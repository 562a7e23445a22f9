#include "tool/shot/schema.h"

#include <algorithm>
#include <set>

#include "tests/tool/shot/shot_files.h"
#include "tool/shot/toml_tree.h"

namespace softreel {
namespace {

using Schema = ShotFiles;

/// Paths of all values in a document, names and positions as the schema writes them.
void collect(const TomlValue& value, const std::string& path, std::set<std::string>& paths) {
  paths.insert(path);
  if (const auto* items = value.array())
    for (const TomlValue& item : *items) collect(item, path == "" ? "[]" : path + "[]", paths);
  if (value.table() == nullptr) return;
  for (const TomlEntry& entry : *value.table()) {
    const std::string key = path == "body" || path == "material" ? "*" : entry.key;
    collect(entry.value, path.empty() ? key : path + "." + key, paths);
  }
}

std::set<std::string> paths_of(const std::string& text) {
  std::set<std::string> paths, single;
  collect(parse_toml(text, "text"), "", paths);
  // A list of selections is described as one selection.
  for (std::string path : paths) {
    const std::size_t list = path.find("select[]");
    if (list != std::string::npos) path.erase(list + 6, 2);
    single.insert(path);
  }
  return single;
}

TEST_F(Schema, DescribesEveryFieldCompletely) {
  std::set<std::string> seen;
  for (const FieldText& text : field_texts()) {
    EXPECT_TRUE(seen.insert(text.path).second) << text.path << " is there twice";
    EXPECT_FALSE(text.type.empty()) << text.path;
    EXPECT_FALSE(text.accepted.empty()) << text.path;
    ASSERT_FALSE(text.sentence.empty()) << text.path;
    EXPECT_TRUE(text.sentence.back() == '.') << text.path;
    const bool part_of_choice = text.path.find("select.") != std::string::npos;
    const bool either = text.path == "body.*.region[].material" || text.path == "body.*.region[].stiffness";
    if (text.is_table || part_of_choice || either) continue;
    EXPECT_FALSE(text.default_value.empty()) << text.path;
  }
  EXPECT_GT(seen.size(), 120u);
}

TEST_F(Schema, IsReadAndWrittenInEveryField) {
  const std::set<std::string> read = paths_of(kFullShot), written = paths_of(to_toml(load(kFullShot)));
  for (const FieldText& text : field_texts()) {
    const std::string& path = text.path;
    if (text.is_table) continue;
    if (path == "use") continue;           // what presets say is written out
    if (path == "solver.error") continue;  // excludes step_error; see ErrorDialOfAShot
    EXPECT_EQ(read.count(path), 1u) << path << " is not in the full shot of these tests";
    EXPECT_EQ(written.count(path), 1u) << path << " is not written";
  }
  for (const std::string& path : written) {
    if (path.empty() || path.back() == ']' || path.back() == '*') continue;
    const auto has = [&path](const FieldText& text) { return text.path == path; };
    EXPECT_TRUE(std::any_of(field_texts().begin(), field_texts().end(), has))
        << path << " is written but not described";
  }
}

/// The full shot as a document that can be changed and written again.
TomlValue with_sections(TomlValue document) {
  for (TomlEntry& entry : *document.table()) {
    entry.value.section = entry.value.table() != nullptr;
    if (entry.key != "body" && entry.key != "material") continue;
    for (TomlEntry& named : *entry.value.table()) named.value.section = true;
  }
  return document;
}

TEST_F(Schema, ChangesTheShotByEveryField) {
  // A field that is read into nothing would leave the written shot as it is without it.
  const std::string full = to_toml(load(kFullShot));
  const TomlValue document = with_sections(parse_toml(full, "full"));
  int changed = 0;
  for (const TomlEntry& section : *document.table()) {
    if (!section.value.section || section.key == "body" || section.key == "material") continue;
    for (const TomlEntry& entry : *section.value.table()) {
      if (section.key == "camera" && entry.key == "mode") continue;  // position and target say it too
      TomlValue without = document;
      std::erase_if(*without.find(section.key)->table(), [&](const TomlEntry& one) { return one.key == entry.key; });
      std::string text;
      try {
        text = to_toml(load(to_document(without)));
      } catch (const Error&) {  // it cannot be left out
      }
      EXPECT_NE(text, full) << section.key << "." << entry.key;
      ++changed;
    }
  }
  EXPECT_GT(changed, 50);
}

TEST_F(Schema, ExplainsPathsOfTheTableAndOfShots) {
  const std::string explained = explain_field("body.*.tets");
  EXPECT_NE(explained.find("20000"), std::string::npos) << explained;
  EXPECT_EQ(explain_field("body.tets"), explained);
  EXPECT_EQ(explain_field("body.creature.tets"), explained);
  EXPECT_NE(explain_field("body.creature.pin[0].keys[1].translate").find("m or heights"), std::string::npos);
  EXPECT_EQ(explain_field("body.pin.keys.translate"), explain_field("body.*.pin[].keys[].translate"));
  EXPECT_NE(explain_field("camera").find("margin"), std::string::npos);
  EXPECT_NE(explain_field("body.creature").find("mesh"), std::string::npos);
  EXPECT_NE(explain_field("body.creature.pin[0].select[1].box.min").find("Lowest corner"), std::string::npos);
  for (const FieldText& text : field_texts()) EXPECT_NO_THROW(explain_field(text.path)) << text.path;
}

TEST_F(Schema, NamesTheNearestOfAnUnknownPath) {
  try {
    explain_field("camera.margn");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("Did you mean 'camera.margin'?"), std::string::npos) << error.what();
  }
}

TEST_F(Schema, ListsEveryFieldInTheReferenceOnce) {
  const std::string reference = shot_reference();
  std::size_t rows = 0;
  for (std::size_t at = reference.find("\n| `"); at != std::string::npos; at = reference.find("\n| `", at + 1)) ++rows;
  std::size_t headings = 0;
  for (std::size_t at = reference.find("\n## `"); at != std::string::npos; at = reference.find("\n## `", at + 1))
    ++headings;
  EXPECT_EQ(rows + headings, field_texts().size());
  for (const char* part : {"## `[body.NAME]`", "## `[[body.NAME.pin]]`", "## `[[light]]`", "## `[material.NAME]`"})
    EXPECT_NE(reference.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace softreel
