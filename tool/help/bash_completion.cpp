#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tool/help/completion.h"

namespace softreel {
namespace {

/// What does not depend on the table. `cur` is the word under the cursor, `shot` the first other word that names one.
constexpr const char* kBashHead = R"(# Completion of softreel for bash, made by `softreel completion bash`.
# Now: source <(softreel completion bash). Always: put that line into ~/.bashrc.

_softreel_words() {  # those of the arguments that begin like the current word
  local word
  for word in "$@"; do [[ $word == "$cur"* ]] && COMPREPLY+=("$word"); done
}

_softreel_ask() {  # the lines that softreel answers with
  local line
  while IFS= read -r line; do
    [[ $line == "$cur"* ]] && COMPREPLY+=("$line")
  done < <("${COMP_WORDS[0]}" completion --list "$@" --shot "${shot/#\~/$HOME}" 2>/dev/null)
}

_softreel_paths() {  # folders, and files with the ending $1; -: folders only
  local path
  compopt -o filenames 2>/dev/null
  while IFS= read -r path; do
    if [[ -d $path || ( $1 != - && $path == *"$1" ) ]]; then COMPREPLY+=("$path"); fi
  done < <(compgen -f -- "$cur")
}

_softreel_set() {  # PATH=VALUE, where bash did not cut it at the equals sign
  if [[ $cur != *=* ]]; then
    _softreel_ask fields
    COMPREPLY=("${COMPREPLY[@]/%/=}")
    compopt -o nospace 2>/dev/null
    return
  fi
  local field=${cur%%=*}
  cur=${cur#*=}
  _softreel_ask values --field "$field"
  COMPREPLY=("${COMPREPLY[@]/#/$field=}")
}

_softreel() {
  local cur=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD-1]} command= shot= i
  COMPREPLY=()
  for ((i = 1; i < ${#COMP_WORDS[@]}; ++i)); do
    if ((i == COMP_CWORD)); then continue; fi
    if [[ -z $command && i -lt COMP_CWORD && ${COMP_WORDS[i]} != -* ]]; then command=${COMP_WORDS[i]}
    elif [[ -z $shot && ${COMP_WORDS[i]} == *.toml ]]; then shot=${COMP_WORDS[i]}; fi
  done
  # Bash cuts at equals signs: "--set body.mode=emb" is four words, "--mode=fast" three.
  local field=
  if [[ $cur == = ]]; then field=$option cur=
  elif [[ $option == = ]]; then field=${COMP_WORDS[COMP_CWORD-2]}; fi
  if [[ -n $field && $field != -* ]]; then
    _softreel_ask values --field "$field"
    return
  fi
  [[ -z $field ]] || option=$field
)";

/// The shell command that completes a value of this kind.
std::string bash_action(const OptionText& option) {
  switch (option.kind) {
    case ArgumentKind::None:
    case ArgumentKind::Text:
      return ":";
    case ArgumentKind::Choice:
      return fmt::format("_softreel_words {}", fmt::join(option.choices, " "));
    case ArgumentKind::File:
      return "_softreel_paths ''";
    case ArgumentKind::Folder:
      return "_softreel_paths -";
    case ArgumentKind::Shot:
      return "_softreel_paths .toml";
    case ArgumentKind::Field:
      return "_softreel_ask fields";
    case ArgumentKind::FieldSet:
      return "_softreel_set";
    case ArgumentKind::Material:
      return "_softreel_ask materials";
    case ArgumentKind::Preset:
      return "_softreel_ask presets";
  }
  return ":";
}

std::string option_names(const CommandText& command) {
  std::string names = "--help";
  for (const OptionText& option : command.options)
    if (!option.positional) names += fmt::format(" {}", fmt::join(option.names, " "));
  return names;
}

std::string value_cases(const CommandText& command) {
  std::string cases;
  for (const OptionText& option : command.options) {
    if (option.positional || option.argument.empty()) continue;
    std::string patterns;
    for (const std::string& name : option.names)
      patterns += fmt::format("{}{}:{}", patterns.empty() ? "" : "|", command.name, name);
    cases += fmt::format("    {}) {}; return ;;\n", patterns, bash_action(option));
  }
  return cases;
}

}  // namespace

std::string bash_completion(const std::vector<CommandText>& commands, const CommandText& program) {
  std::string script = kBashHead;
  script += "  case $command:$option in\n";
  for (const CommandText& command : commands) script += value_cases(command);
  script += "  esac\n  case $command in\n";
  std::string names;
  for (const CommandText& command : commands) {
    names += (names.empty() ? "" : " ") + command.name;
    script += fmt::format("    {})\n      if [[ $cur == -* ]]; then _softreel_words {}\n", command.name,
                          option_names(command));
    std::string words;
    for (const OptionText& option : command.options)
      if (option.positional) words += bash_action(option) + "; ";
    script += fmt::format("      else {}fi ;;\n", words.empty() ? ":; " : words);
  }
  script +=
      fmt::format("    '')\n      if [[ $cur == -* ]]; then _softreel_words {}\n      else _softreel_words {}; fi ;;\n",
                  option_names(program), names);
  return script + "  esac\n}\n\ncomplete -F _softreel softreel\n";
}

}  // namespace softreel
