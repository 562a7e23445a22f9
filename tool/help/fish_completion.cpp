#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tool/help/completion.h"

namespace softreel {
namespace {

constexpr const char* kFishHead = R"(# Completion of softreel for fish, made by `softreel completion fish`: put it into
# ~/.config/fish/completions/softreel.fish, or: softreel completion fish | source

function __softreel_ask
    set -l words (commandline -opc)
    set -l shot (string match -- '*.toml' $words)[1]
    $words[1] completion --list $argv --shot "$shot" 2>/dev/null
end

function __softreel_set
    set -l word (commandline -ct)
    if string match -q -- '*=*' $word
        set -l field (string split -m1 = -- $word)[1]
        string replace -r -- '^' "$field=" (__softreel_ask values --field $field)
    else
        string replace -r -- '$' = (__softreel_ask fields)
    end
end

complete -c softreel -f
)";

std::string fish_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

/// What `-a` is given.
std::string fish_action(const OptionText& option) {
  switch (option.kind) {
    case ArgumentKind::None:
    case ArgumentKind::Text:
      return "";
    case ArgumentKind::Choice:
      return fmt::format("{}", fmt::join(option.choices, " "));
    case ArgumentKind::File:
      return "(__fish_complete_path (commandline -ct))";
    case ArgumentKind::Folder:
      return "(__fish_complete_directories (commandline -ct))";
    case ArgumentKind::Shot:
      return "(__fish_complete_suffix .toml)";
    case ArgumentKind::Field:
      return "(__softreel_ask fields)";
    case ArgumentKind::FieldSet:
      return "(__softreel_set)";
    case ArgumentKind::Material:
      return "(__softreel_ask materials)";
    case ArgumentKind::Preset:
      return "(__softreel_ask presets)";
  }
  return "";
}

std::string line(const OptionText& option, const std::string& condition) {
  std::string text = fmt::format("complete -c softreel -n {}", fish_quoted(condition));
  if (!option.positional)
    for (const std::string& name : option.names)
      text += name.starts_with("--") ? fmt::format(" -l {}", name.substr(2)) : fmt::format(" -s {}", name.substr(1));
  if (!option.positional && !option.argument.empty()) text += " -x";
  if (!option.argument.empty() && !fish_action(option).empty())
    text += fmt::format(" -a {}", fish_quoted(fish_action(option)));
  return text + fmt::format(" -d {}\n", fish_quoted(option.sentence));
}

}  // namespace

std::string fish_completion(const std::vector<CommandText>& commands, const CommandText& program) {
  std::string script = kFishHead;
  for (const OptionText& option : program.options) script += line(option, "__fish_use_subcommand");
  for (const CommandText& command : commands)
    script += fmt::format("complete -c softreel -n __fish_use_subcommand -a {} -d {}\n", command.name,
                          fish_quoted(command.sentence));
  for (const CommandText& command : commands)
    for (const OptionText& option : command.options)
      script += line(option, "__fish_seen_subcommand_from " + command.name);
  return script;
}

}  // namespace softreel
