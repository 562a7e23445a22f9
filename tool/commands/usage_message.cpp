#include "tool/commands/usage_message.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/nearest_name.h"

namespace softreel {
namespace {

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options({}))
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// "Did you mean --frames? ", or nothing.
std::string guess(const std::string& unknown, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(unknown.substr(0, unknown.find('=')), known);
  return nearest.empty() ? "" : fmt::format("Did you mean {}? ", nearest);
}

/// The words that the command has no place for, in their order; empty if there are none. CLI11 says them backwards.
std::string extra_words(const CLI::App& command) {
  const std::vector<std::string> extra = command.remaining();
  if (extra.empty()) return "";
  const auto option = std::find_if(extra.begin(), extra.end(), [](const auto& word) { return word.starts_with('-'); });
  return fmt::format("not expected: {}.\n  {}", fmt::join(extra, " "),
                     option == extra.end() ? "" : guess(*option, option_names(command)));
}

std::string command_message(const CLI::App& command, const CLI::ParseError& mistake) {
  const std::string extra = extra_words(command), name = command.get_name();
  return fmt::format("{}: {}See softreel {} --help.", name,
                     extra.empty() ? fmt::format("{}\n  ", mistake.what()) : extra, name);
}

}  // namespace

std::string usage_message(const CLI::App& app, const CLI::ParseError& mistake, int argc, char** argv) {
  const std::string word = argc > 1 ? argv[1] : "";
  const std::vector<std::string> names = subcommand_names(app);
  if (std::find(names.begin(), names.end(), word) != names.end())
    return command_message(*app.get_subcommand(word), mistake);
  const std::string accepted =
      fmt::format("softreel SUBCOMMAND ... with one of {}. See softreel --help.", fmt::join(names, ", "));
  if (word.empty() || word.starts_with('-')) {
    const std::string extra = extra_words(app);
    return fmt::format("{}Accepted: {}", extra.empty() ? fmt::format("{}\n  ", mistake.what()) : extra, accepted);
  }
  return fmt::format("\"{}\" is no subcommand.\n  {}Accepted: {}. See softreel --help.", word, guess(word, names),
                     fmt::join(names, ", "));
}

}  // namespace softreel
