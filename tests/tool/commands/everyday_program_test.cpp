/// explain, --version and the log, through the built program.
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

TEST(Explain, SaysWhatAFieldIsAndWhereItsValueComesFrom) {
  const std::string folder = shot_folder("explain");
  const Outcome outcome = run(fmt::format("softreel explain body.*.tets --shot {}/shot.toml", folder));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* word :
       {"Unit: none", "Default: 20000", "Example:", "body.*.edge", "body.tets = 700", "shot.toml:8:"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word << " in\n" << outcome.out;
  const Outcome set =
      run(fmt::format("softreel explain render.samples --shot {}/shot.toml --set render.samples=9 --json", folder));
  const json report = json::parse(set.out);
  EXPECT_EQ(report["values"][0]["value"], "9");
  EXPECT_EQ(report["values"][0]["layer"], "--set");
  EXPECT_EQ(report["unit"], "paths a pixel");
}

TEST(Options, ThatMayBeRepeatedLeaveTheShotAlone) {
  const std::string shot = shot_folder("options") + "/shot.toml";
  const Outcome checked = run("softreel check --set render.samples=3 --set render.width=64 " + shot);
  EXPECT_EQ(checked.status, 0) << checked.err;
}

TEST(Explain, SaysWhatAQualityChanges) {
  const std::string shot = "'" SOFTREEL_SOURCE_DIR "/presets/first_pull.toml'";
  const auto value = [&](const std::string& field, const std::string& options) {
    const Outcome outcome = run(fmt::format("softreel explain {} --shot {} {} --json", field, shot, options));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out)["values"][0]["value"].get<std::string>();
  };
  EXPECT_EQ(value("render.scale", "--quality draft"), "0.5");
  EXPECT_EQ(value("render.samples", "--quality final"), "256");
  EXPECT_EQ(value("render.samples", "--set render.samples=5 --quality final"), "5");
  EXPECT_EQ(value("render.samples", "--quality '" SOFTREEL_SOURCE_DIR "/presets/quality/final.toml'"), "256");
  const Outcome said = run("softreel explain render.scale --quality draft --shot " + shot);
  EXPECT_NE(said.out.find("quality/draft.toml:3:9, --quality)"), std::string::npos) << said.out;
  const Outcome unknown = run("softreel render " + shot + " --quality darft");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("Did you mean draft?"), std::string::npos) << unknown.err;
}

TEST(Explain, KnowsTopicsAndRefusesWhatItDoesNotKnow) {
  EXPECT_NE(run("softreel explain exit-status").out.find("130"), std::string::npos);
  EXPECT_NE(run("softreel explain").out.find("exit-status"), std::string::npos);
  const Outcome unknown = run("softreel explain render.sampels");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("render.samples"), std::string::npos) << unknown.err;
  EXPECT_EQ(run("softreel explain tets --set body.tets=3").status, 2);
  for (const char* words : {"tets --shot none.toml", "body --shot none.toml", "exit-status --json", "--json"})
    EXPECT_EQ(run(fmt::format("softreel explain {}", words)).status, 2) << words;
}

TEST(Version, NamesLibrariesPartsAndTheMachine) {
  const Outcome outcome = run("softreel --version --json");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json facts = json::parse(outcome.out);
  for (const char* library : {"Eigen", "oneTBB", "OpenEXR", "libpng", "fmt", "CLI11", "toml++", "xxHash"})
    EXPECT_FALSE(facts["libraries"][library]["version"].get<std::string>().empty()) << library;
  EXPECT_EQ(facts["threads"], std::max(1u, std::thread::hardware_concurrency()));
  EXPECT_EQ(facts["instruction_set"], "x86-64-v3");
  for (const auto& [name, part] : facts["parts"].items()) {
    const std::string file = part["file"];
    EXPECT_TRUE(file.empty() || std::filesystem::exists(file)) << name;
    EXPECT_TRUE(name == "ffmpeg" || part["found"] == part["built_in"]) << name;
  }
  const Outcome text = run("softreel --version");
  EXPECT_EQ(text.status, 0);
  EXPECT_NE(text.out.find(facts["libraries"]["OpenEXR"]["version"].get<std::string>()), std::string::npos) << text.out;
  EXPECT_EQ(run("softreel --json").status, 2) << "--json alone asks for nothing";
  EXPECT_EQ(run("PATH=/nowhere softreel --version --json").out.find("\"file\": \"/usr/bin/ffmpeg\""),
            std::string::npos);
}

/// What a short simulation says at a level, on standard error.
std::string said(const std::string& folder, const std::string& options, const std::string& environment = "") {
  run(fmt::format("rm -rf {}/out", folder));  // what is done says nothing
  const Outcome outcome = run(fmt::format("{1} softreel simulate {0}/shot.toml --output {0}/out --frames 1-2 {2}",
                                          folder, environment.empty() ? "" : "export " + environment + ";", options));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.err;
}

TEST(LogLevels, SayMoreFromLevelToLevel) {
  const std::string folder = shot_folder("levels");
  const std::string mark = "results kept in";  // of a line of the level debug
  EXPECT_EQ(said(folder, "--quiet"), "");
  EXPECT_EQ(said(folder, "--log-level error"), "");
  const std::string normal = said(folder, "");
  EXPECT_NE(normal, "");
  EXPECT_EQ(normal.find(mark), std::string::npos);
  for (const char* verbose : {"--verbose", "--log-level debug"})
    EXPECT_NE(said(folder, verbose).find(mark), std::string::npos) << verbose;
}

TEST(LogLevels, ComeFromTheEnvironmentWhereNoOptionSaysOtherwise) {
  const std::string folder = shot_folder("level_variable");
  EXPECT_EQ(said(folder, "", "SOFTREEL_LOG=warning"), "");
  EXPECT_NE(said(folder, "", "SOFTREEL_LOG=debug").find("results kept in"), std::string::npos);
  EXPECT_EQ(said(folder, "--quiet", "SOFTREEL_LOG=debug"), "");
  EXPECT_NE(said(folder, "--log-level info", "SOFTREEL_LOG=error"), "");
  const Outcome wrong = run(fmt::format("export SOFTREEL_LOG=loud; softreel check {}/shot.toml", folder));
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("debug"), std::string::npos) << wrong.err;
  EXPECT_EQ(run(fmt::format("softreel check {}/shot.toml --quiet --verbose", folder)).status, 2);
}

TEST(LogLevels, AllGoIntoTheLogFileAndErrorsToo) {
  const std::string folder = shot_folder("log_file");
  const std::string option = fmt::format("--quiet --log-file {}/softreel.log", folder);
  EXPECT_EQ(said(folder, option), "");
  const std::string first = read_text(folder + "/softreel.log");
  EXPECT_NE(first.find(" debug: "), std::string::npos) << first;
  EXPECT_NE(first.find(" info: "), std::string::npos) << first;
  EXPECT_EQ(run(fmt::format("softreel check {}/none.toml {}", folder, option)).status, 2);
  const std::string second = read_text(folder + "/softreel.log");
  EXPECT_TRUE(second.starts_with(first)) << "it was not added to the end";
  EXPECT_NE(second.find(" error: "), std::string::npos) << second;
  EXPECT_EQ(run(fmt::format("softreel check {0}/shot.toml --log-file {0}/no/folder.log", folder)).status, 1);
}

TEST(LogLevels, AreOptionsOfEveryCommand) {
  const json table = json::parse(run("softreel completion json").out);
  for (const json& command : table["commands"]) {
    std::string names;
    for (const json& option : command["options"]) names += option["names"].back().get<std::string>() + " ";
    for (const char* option : {"--quiet", "--verbose", "--log-level", "--log-file"})
      EXPECT_NE(names.find(option), std::string::npos) << command["name"] << " lacks " << option;
  }
}

}  // namespace
}  // namespace softreel
