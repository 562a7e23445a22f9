#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tool/help/completion.h"

namespace softreel {
namespace {

constexpr const char* kZshHead = R"zsh(#compdef softreel
# Completion of softreel for zsh, made by `softreel completion zsh`: a file _softreel in a folder of $fpath, or
# source <(softreel completion zsh) after compinit.

_softreel_ask() {  # prints the lines that softreel answers with
  local word shot=
  for word in $_softreel_line; do
    if [[ $word == *.toml ]]; then shot=$word; break; fi
  done
  ${(Q)_softreel_line[1]} completion --list "$@" --shot "${(Q)${shot/#\~/$HOME}}" 2>/dev/null
}

_softreel_lines() {
  local -a lines
  lines=(${(f)"$(_softreel_ask "$@")"})
  compadd -a lines
}

_softreel_set() {  # PATH=VALUE
  local -a lines
  if [[ $PREFIX == *'='* ]]; then
    local field=${PREFIX%%'='*}
    compset -P '*='
    lines=(${(f)"$(_softreel_ask values --field "${(Q)field}")"})
    compadd -a lines
  else
    lines=(${(f)"$(_softreel_ask fields)"})
    compadd -S = -a lines
  fi
}

)zsh";

/// Text between single quotes of the shell, with what _arguments takes for its own escaped.
std::string zsh_quoted(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
      continue;
    }
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

/// What _arguments runs; with a blank before it, it passes on nothing of its own.
std::string zsh_action(const OptionText& option) {
  switch (option.kind) {
    case ArgumentKind::None:
    case ArgumentKind::Text:
      return " ";
    case ArgumentKind::Choice:
      return fmt::format("({})", fmt::join(option.choices, " "));
    case ArgumentKind::File:
      return "_files";
    case ArgumentKind::Folder:
      return "_files -/";
    case ArgumentKind::Shot:
      return "_files -g \"*.toml\"";
    case ArgumentKind::Field:
      return " _softreel_lines fields";
    case ArgumentKind::FieldSet:
      return "_softreel_set";
    case ArgumentKind::Material:
      return " _softreel_lines materials";
    case ArgumentKind::Preset:
      return " _softreel_lines presets";
  }
  return " ";
}

/// One argument of _arguments.
std::string spec(const OptionText& option, const std::string& name, int position) {
  if (option.positional)
    return fmt::format("'{}:{}:{}'", option.repeatable ? "*" : std::to_string(position),
                       zsh_quoted(option.names.front()), zsh_action(option));
  const std::string value =
      option.argument.empty() ? "" : fmt::format(":{}:{}", zsh_quoted(option.argument), zsh_action(option));
  return fmt::format("'{}{}[{}]{}'", option.repeatable ? "*" : "", name, zsh_quoted(option.sentence), value);
}

std::string specs(const CommandText& command) {
  std::string text = "'--help[say what it takes]'";
  int position = 0;
  for (const OptionText& option : command.options) {
    if (option.positional) ++position;
    for (const std::string& name : option.names) text += " \\\n        " + spec(option, name, position);
  }
  return text;
}

}  // namespace

std::string zsh_completion(const std::vector<CommandText>& commands, const CommandText& program) {
  std::string script = kZshHead;
  script +=
      "_softreel() {\n  local curcontext=$curcontext state line\n  typeset -A opt_args\n"
      "  local -a _softreel_line commands\n  _softreel_line=($words)\n  commands=(\n";
  for (const CommandText& command : commands)
    script += fmt::format("    '{}:{}'\n", command.name, zsh_quoted(command.sentence));
  script += fmt::format(
      "  )\n  _arguments -C {} \\\n        '1:command:->command' '*::argument:->argument' && return\n", specs(program));
  script +=
      "  case $state in\n    command) _describe -t commands 'softreel command' commands ;;\n    argument)\n"
      "      case $words[1] in\n";
  for (const CommandText& command : commands)
    script += fmt::format("      {}) _arguments {} ;;\n", command.name, specs(command));
  script += "      esac ;;\n  esac\n}\n\n";
  // As a file of $fpath the body is called by its name at once; when sourced it is announced.
  return script + "if [[ $funcstack[1] == _softreel ]]; then _softreel \"$@\"; else compdef _softreel softreel; fi\n";
}

}  // namespace softreel
