// Options of an export: what is no value, and what a format could only ignore, is refused by name.
#include "tool/export/export_options.h"

#include "tests/tool/export/format_runs.h"

namespace softreel {
namespace {

ExportSettings settings_of(const ExportWishes& wishes) {
  return export_settings(wishes, chosen_formats(wishes));
}

/// A wish of formats, which the caller may add to.
ExportWishes wish(const std::vector<std::string>& formats) {
  ExportWishes wishes;
  wishes.formats = formats;
  return wishes;
}

void expect_refused(const ExportWishes& wishes, const std::vector<std::string>& words) {
  const std::string message = testing::error_of([&] { settings_of(wishes); });
  for (const std::string& word : words)
    EXPECT_NE(message.find(word), std::string::npos) << "no \"" << word << "\" in: " << message;
}

TEST(ExportOptions, NameFormatsOnceAndTheirRate) {
  ExportWishes wishes = wish({"mdd", "usda", "mdd"});
  EXPECT_EQ(chosen_formats(wishes).size(), 2U);
  wishes.fps = 30;
  EXPECT_EQ(settings_of(wishes).fps, 30);
  EXPECT_EQ(chosen_formats({}).at(0)->name, "obj");
}

TEST(ExportOptions, KnowUnitsByNameAndInMetres) {
  ExportWishes wishes = wish({"usda"});
  const std::vector<std::pair<std::string, double>> units{{"m", 1},       {"cm", 0.01},   {"mm", 0.001},
                                                          {"in", 0.0254}, {"ft", 0.3048}, {"2.5", 2.5}};
  for (const auto& [text, meters] : units) {
    wishes.unit = text;
    EXPECT_EQ(settings_of(wishes).meters_per_unit, meters) << text;
  }
  for (const char* bad : {"km", "0", "-1", "1x", "nan", "inf", "1e999"}) {
    wishes.unit = bad;
    expect_refused(wishes, {"--unit", bad, "Accepted: m, cm, mm, in, ft"});
  }
}

TEST(ExportOptions, RefuseWordsThatAreNone) {
  expect_refused(wish({"fbx"}), {"--format", "fbx", "obj, ply, pc2"});
  expect_refused(wish({"gbl"}), {"--format", "gbl", "Did you mean glb?"});
  ExportWishes wishes = wish({"obj"});
  wishes.space = "camera";
  expect_refused(wishes, {"--space", "camera", "object", "world"});
  wishes.space = "world";
  wishes.up = "x";
  expect_refused(wishes, {"--up", "\"x\"", "y, z"});
}

TEST(ExportOptions, RefuseWhatAFormatCouldOnlyIgnore) {
  ExportWishes wishes = wish({"obj", "pc2"});
  wishes.normals = true;
  expect_refused(wishes, {"--normals", "pc2", "Accepted: with obj, ply, glb, usda"});
  wishes = wish({"ply"});
  wishes.fps = 25;
  expect_refused(wishes, {"--fps", "ply", "Accepted: with mdd, glb, usda"});
  wishes = wish({"glb"});
  wishes.unit = "cm";
  expect_refused(wishes, {"--unit", "glb", "metres"});
  wishes = wish({"mdd"});
  wishes.up = "z";
  expect_refused(wishes, {"--up", "mdd", "object space", "--space world, or with usda"});
  wishes.space = "world";
  EXPECT_EQ(settings_of(wishes).up, UpAxis::Z);
}

TEST(ExportFormats, AllHaveANameOfTheirOwnAndALine) {
  std::vector<std::string> names;
  for (const ExportFormat& format : export_formats()) {
    EXPECT_EQ(std::count(names.begin(), names.end(), format.name), 0) << format.name;
    names.push_back(format.name);
    EXPECT_FALSE(format.about.empty());
    EXPECT_EQ(format.about.find('\n'), std::string::npos);
    EXPECT_TRUE(format.make) << format.name;
  }
}

}  // namespace
}  // namespace softreel
