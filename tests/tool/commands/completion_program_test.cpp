/// Completion in shells, the manual page and the table of commands that they come from.
#include <algorithm>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;
using Words = std::set<std::string>;

json command_table() {
  const Outcome outcome = run("softreel completion json");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return json::parse(outcome.out);
}

bool is_installed(const char* program) {
  return run(fmt::format("command -v {}", program)).status == 0;
}

/// Words that bash would offer in `folder`, where it has cut the line into `words`; the last is under the cursor.
class Bash {
 public:
  Bash() : folder_(shot_folder("completion")) {
    EXPECT_EQ(run(fmt::format("softreel completion bash > {}/softreel.bash", folder_)).status, 0);
    EXPECT_EQ(run(fmt::format("mkdir {}/deep", folder_)).status, 0);
  }
  Words offers(const std::vector<std::string>& words) const {
    std::string line;
    for (const std::string& word : words) line += fmt::format(" '{}'", word);
    write_text(folder_ + "/ask.bash",
               fmt::format("source ./softreel.bash\nCOMP_WORDS=('{}'{})\nCOMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))\n"
                           "_softreel\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"\n",
                           SOFTREEL_PROGRAM, line));
    const Outcome outcome = run(fmt::format("cd {} && bash --norc -u ask.bash", folder_));
    EXPECT_EQ(outcome.err, "");
    Words all;
    std::istringstream lines(outcome.out);
    for (std::string one; std::getline(lines, one);)
      if (!one.empty()) all.insert(one);
    return all;
  }

 private:
  std::string folder_;
};

TEST(BashCompletion, OffersEveryCommandAndEveryOptionOfTheTable) {
  const Bash bash;
  const json table = command_table();
  Words commands;
  for (const json& command : table["commands"]) commands.insert(command["name"]);
  EXPECT_EQ(bash.offers({""}), commands);
  EXPECT_TRUE(commands.count("new") > 0 && commands.count("render") > 0);
  for (const json& command : table["commands"]) {
    Words options{"--help"};
    for (const json& option : command["options"])
      if (!option["positional"])
        for (const std::string name : option["names"]) options.insert(name);
    EXPECT_EQ(bash.offers({command["name"], "-"}), options) << command["name"];
  }
}

TEST(BashCompletion, OffersValuesOfOptions) {
  const Bash bash;
  EXPECT_EQ(bash.offers({"ren"}), Words{"render"});
  EXPECT_EQ(bash.offers({"preview", "--mode", ""}), (Words{"shadows", "fast"}));
  EXPECT_EQ(bash.offers({"preview", "--mode", "=", "f"}), Words{"fast"});
  EXPECT_EQ(bash.offers({"export", "shot.toml", "--format", "pc"}), Words{"pc2"});
  EXPECT_EQ(bash.offers({"new", "sphere.obj", "--material", "rub"}), Words{"rubber"});
  EXPECT_EQ(bash.offers({"new", "sphere.obj", "--like", "first"}), Words{"first_pull"});
  EXPECT_EQ(bash.offers({"render", "shot.toml", "--threads", ""}), Words());
}

TEST(BashCompletion, OffersFilesOfTheKindThatIsAskedFor) {
  const Bash bash;
  EXPECT_EQ(bash.offers({"render", ""}), (Words{"shot.toml", "deep"}));
  EXPECT_EQ(bash.offers({"inspect", "sp"}), Words{"sphere.obj"});
  EXPECT_EQ(bash.offers({"render", "shot.toml", "--output", ""}), Words{"deep"});
}

TEST(BashCompletion, OffersFieldsOfTheShotAndTheirValues) {
  const Bash bash;
  EXPECT_EQ(bash.offers({"render", "shot.toml", "--set", "body.te"}), (Words{"body.tets=", "body.tetrahedra="}));
  EXPECT_EQ(bash.offers({"render", "shot.toml", "--set", "material.soft.youngs"}),
            Words{"material.soft.youngs_modulus="});
  EXPECT_EQ(bash.offers({"render", "shot.toml", "--set", "body.pull[0].stiffness"}).count("body.pull[0].stiffness="),
            1u);
  EXPECT_EQ(bash.offers({"render", "shot.toml", "--set", "body.pull[1]"}), Words()) << "there is one pull";
  EXPECT_EQ(bash.offers({"render", "shot.toml", "--set", "output.view", "=", "f"}), Words{"filmic"});
  EXPECT_EQ(bash.offers({"render", "shot.toml", "--set", "body.material", "="}), Words{"soft"});
  EXPECT_EQ(bash.offers({"explain", "render.max_b"}), Words{"render.max_bounces"});
}

TEST(FishCompletion, OffersCommandsOptionsAndFields) {
  if (!is_installed("fish")) GTEST_SKIP() << "fish is not installed";
  const std::string folder = shot_folder("fish");
  const auto offers = [&](const std::string& line) {
    const Outcome outcome = run(
        fmt::format("cd {0} && '{1}' completion fish > s.fish && PATH=\"$(dirname '{1}'):$PATH\" fish --no-config -c "
                    "\"source s.fish; complete "
                    "-C '{2}'\"",
                    folder, SOFTREEL_PROGRAM, line));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  };
  EXPECT_NE(offers("softreel ren").find("render"), std::string::npos);
  EXPECT_NE(offers("softreel preview --mode ").find("shadows"), std::string::npos);
  EXPECT_NE(offers("softreel render shot.toml --set body.te").find("body.tets="), std::string::npos);
  EXPECT_NE(offers("softreel render shot.toml --set output.view=f").find("output.view=filmic"), std::string::npos);
}

TEST(ZshCompletion, IsAScriptThatZshReads) {
  if (!is_installed("zsh")) GTEST_SKIP() << "zsh is not installed";
  const std::string folder = new_folder("zsh");
  const Outcome outcome = run(fmt::format(
      "cd {0} && '{1}' completion zsh > _softreel && zsh -n _softreel && zsh -f -c 'autoload -U compinit; compinit -D; "
      "source ./_softreel; print $_comps[softreel]'",
      folder, SOFTREEL_PROGRAM));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(outcome.out, "_softreel\n");
}

TEST(CommandTable, SaysOfEveryCommandAndOptionWhatItIsFor) {
  const json table = command_table();
  const std::string help = run("softreel --help").out;
  for (const json& command : table["commands"]) {
    const std::string name = command["name"];
    EXPECT_NE(help.find(name), std::string::npos) << name;
    EXPECT_FALSE(command["sentence"].get<std::string>().empty()) << name;
    const Outcome own = run(fmt::format("softreel {} --help", name));
    EXPECT_EQ(own.status, 0) << name;
    for (const json& option : command["options"]) {
      const std::string first = option["names"].back();
      EXPECT_FALSE(option["sentence"].get<std::string>().empty()) << name << " " << first;
      EXPECT_NE(own.out.find(first), std::string::npos) << name << " " << first;
    }
  }
}

TEST(ManualPage, NamesEveryCommandOptionAndExitStatusWithoutAWarning) {
  const std::string folder = new_folder("man");
  ASSERT_EQ(run(fmt::format("softreel man > {}/softreel.1", folder)).status, 0);
  const std::string source = read_text(folder + "/softreel.1");
  EXPECT_NE(source.find("\n.br\nply: "), std::string::npos) << "each format on a line of its own";
  if (!is_installed("groff")) GTEST_SKIP() << "groff is not installed";
  const Outcome page = run(fmt::format("groff -ww -man -Tascii -P-c -P-b -P-u -rLL=200n {}/softreel.1", folder));
  EXPECT_EQ(page.status, 0);
  EXPECT_EQ(page.err, "") << "warnings of groff";
  for (const json& command : command_table()["commands"]) {
    EXPECT_NE(page.out.find("softreel " + command["name"].get<std::string>()), std::string::npos) << command["name"];
    for (const json& option : command["options"])
      for (const std::string name : option["names"])
        EXPECT_NE(page.out.find(name), std::string::npos) << command["name"] << " " << name;
  }
  for (const char* heading : {"EXIT STATUS", "ENVIRONMENT", "FILES", "EXAMPLES", "SOFTREEL_LOG", "130"})
    EXPECT_NE(page.out.find(heading), std::string::npos) << heading;
}

}  // namespace
}  // namespace softreel
