#include "tool/help/command_table.h"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "tool/cache/json_text.h"

namespace softreel {
namespace {

/// What stands between braces in the type that CLI11 shows of an option with a fixed set of values: "TEXT:{a,b}".
std::vector<std::string> checked_choices(const std::string& type) {
  const std::size_t open = type.find('{'), close = type.find('}');
  std::vector<std::string> choices;
  if (open == std::string::npos || close == std::string::npos || close < open) return choices;
  std::string word;
  for (std::size_t i = open + 1; i <= close; ++i) {
    if (type[i] != ',' && i != close) {
      word += type[i];
      continue;
    }
    if (!word.empty()) choices.push_back(word);
    word.clear();
  }
  return choices;
}

/// The choices of a sentence that begins with them, "obj | ply (with colours) | pc2 [obj]": the first word of each
/// part. None unless there are two.
std::vector<std::string> said_choices(const std::string& sentence) {
  constexpr std::string_view kBar = " | ";
  std::vector<std::string> choices;
  for (std::size_t at = 0; at != std::string::npos;) {
    choices.push_back(sentence.substr(at, sentence.find_first_of(" ,;:", at) - at));
    const std::size_t bar = sentence.find(kBar, at);
    at = bar == std::string::npos ? bar : bar + kBar.size();
  }
  return choices.size() > 1 ? choices : std::vector<std::string>();
}

/// The choices of a sentence that has a line for each of them, "NAME: what it is".
std::vector<std::string> listed_choices(const std::string& sentence) {
  std::vector<std::string> choices;
  for (std::size_t line = sentence.find('\n'); line != std::string::npos; line = sentence.find('\n', line + 1)) {
    const std::size_t end = sentence.find_first_of(" :\n", line + 1);
    if (end != std::string::npos && sentence[end] == ':') choices.push_back(sentence.substr(line + 1, end - line - 1));
  }
  return choices;
}

ArgumentKind kind_of(const std::string& argument) {
  const std::string word = argument.substr(0, argument.find(' '));  // "SHOT ..." takes several
  static constexpr std::pair<std::string_view, ArgumentKind> kKinds[] = {
      {"MESH", ArgumentKind::File},         {"FILE", ArgumentKind::File},     {"DIR", ArgumentKind::Folder},
      {"SHOT", ArgumentKind::Shot},         {"FIELD", ArgumentKind::Field},   {"PATH=VALUE", ArgumentKind::FieldSet},
      {"MATERIAL", ArgumentKind::Material}, {"PRESET", ArgumentKind::Preset},
  };
  for (const auto& [name, kind] : kKinds)
    if (word == name) return kind;
  return word.find('.') == std::string::npos ? ArgumentKind::Text : ArgumentKind::File;
}

OptionText option_text(const CLI::Option& option) {
  OptionText text;
  text.positional = option.nonpositional() == false && option.get_positional();
  const std::string type = option.get_type_name();
  const bool is_flag = option.get_items_expected_max() == 0;
  text.sentence = option.get_description();
  if (!is_flag) {
    text.choices = checked_choices(type);
    if (text.choices.empty() && option.get_option_text().empty()) text.choices = said_choices(text.sentence);
    if (text.choices.empty()) text.choices = listed_choices(text.sentence);
    text.argument = option.get_option_text();
    if (text.argument.empty())
      text.argument = text.choices.empty() ? type.substr(0, type.find_first_of(":{[ ")) : "NAME";
    text.kind = text.choices.empty() ? kind_of(text.argument) : ArgumentKind::Choice;
  }
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  if (text.positional) text.names = {text.argument.substr(0, text.argument.find(' '))};
  text.group = option.get_group();
  text.required = option.get_required();
  text.repeatable =
      option.get_items_expected_max() > 1 || option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  return text;
}

CommandText command_text(const CLI::App& app) {
  CommandText command{app.get_name(), app.get_description(), {}};
  for (const CLI::Option* option : app.get_options()) {
    if (option == app.get_help_ptr() || option->get_group().empty()) continue;
    command.options.push_back(option_text(*option));
  }
  std::stable_sort(command.options.begin(), command.options.end(),
                   [](const OptionText& a, const OptionText& b) { return a.positional && !b.positional; });
  return command;
}

const char* kind_name(ArgumentKind kind) {
  static constexpr const char* kNames[] = {"flag", "text",  "choice",   "file",     "folder",
                                           "shot", "field", "fieldset", "material", "preset"};
  return kNames[static_cast<std::size_t>(kind)];
}

nlohmann::ordered_json to_json(const CommandText& command) {
  nlohmann::ordered_json options = nlohmann::ordered_json::array();
  for (const OptionText& option : command.options)
    options.push_back({{"names", option.names},
                       {"positional", option.positional},
                       {"required", option.required},
                       {"repeatable", option.repeatable},
                       {"argument", option.argument},
                       {"kind", kind_name(option.kind)},
                       {"choices", option.choices},
                       {"group", option.group},
                       {"sentence", option.sentence}});
  return {{"name", command.name}, {"sentence", command.sentence}, {"options", options}};
}

}  // namespace

std::vector<CommandText> command_texts(const CLI::App& app) {
  std::vector<CommandText> commands;
  for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command_text(*command));
  return commands;
}

CommandText program_text(const CLI::App& app) {
  return command_text(app);
}

std::string command_table_json(const CLI::App& app) {
  nlohmann::ordered_json json = {{"program", to_json(program_text(app))}};
  json["commands"] = nlohmann::ordered_json::array();
  for (const CommandText& command : command_texts(app)) json["commands"].push_back(to_json(command));
  return json_text(json);
}

std::string synopsis(const CommandText& command) {
  std::string line;
  for (const OptionText& option : command.options)
    if (option.positional)
      line += (line.empty() ? "" : " ") + (option.required ? option.argument : "[" + option.argument + "]");
    else if (option.required)
      line += (line.empty() ? "" : " ") + option.names.front() + " " + option.argument;
  return line + (line.empty() ? "" : " ") + "[OPTION ...]";
}

}  // namespace softreel
