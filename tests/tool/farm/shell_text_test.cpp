#include "tool/farm/shell_text.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/tool/farm/shell.h"

namespace softreel {
namespace {

using namespace softreel::testing;

std::string through_bash(const std::string& text) {
  return run_bash("printf '%s' " + shell_quoted(text)).said;
}

TEST(ShellText, ComesOutOfBashAsItWentIn) {
  for (const std::string& text : {std::string(), std::string("plain"), std::string("'"), std::string("''"),
                                  std::string("a b"), std::string("\n"), std::string("-n"), std::string("{{"), kNasty})
    EXPECT_EQ(through_bash(text), text);
}

TEST(ShellText, ComesOutOfBashAsItWentInWhateverTheBytes) {
  std::mt19937 random(1);
  std::string all;
  std::uniform_int_distribution<int> byte(1, 255);
  for (int i = 0; i < 4000; ++i) all += static_cast<char>(byte(random));
  EXPECT_EQ(through_bash(all), all);
  std::string special;
  const std::string characters = "'{}\"\\$` \n";
  std::uniform_int_distribution<std::size_t> which(0, characters.size() - 1);
  for (int i = 0; i < 4000; ++i) special += characters[which(random)];
  EXPECT_EQ(through_bash(special), special);
}

TEST(ShellText, HoldsNoReferenceOfATemplate) {
  for (const char* text : {"{{", "{{{", "{{{{", "a{{b}}c", "}}", "'{{'"}) {
    EXPECT_EQ(shell_quoted(text).find("{{"), std::string::npos) << text;
    EXPECT_EQ(shell_quoted(text).find("}}"), std::string::npos) << text;
    EXPECT_EQ(through_bash(text), text);
  }
}

TEST(ShellText, SeparatesTheWordsOfACommand) {
  const std::vector<std::string> words{"printf", "%s|", "", kNasty, "--name=a b", "plain"};
  EXPECT_EQ(run_bash(shell_command(words)).said, "|" + kNasty + "|--name=a b|plain|");
}

}  // namespace
}  // namespace softreel
