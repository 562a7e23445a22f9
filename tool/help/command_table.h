/// Commands and options of softreel as plain values, read off the parser of the command line: what --help, the manual
/// page, the completion of shells and the tests of the documentation share.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace softreel {

/// What an argument stands for, by the name that its help gives it: what a shell can complete.
enum class ArgumentKind {
  None,      ///< a flag
  Text,      ///< numbers and anything else that nobody can guess
  Choice,    ///< one of `choices`
  File,      ///< MESH, FILE, and names with an ending (OUT.png)
  Folder,    ///< DIR
  Shot,      ///< SHOT: a TOML file
  Field,     ///< FIELD: the path of a field
  FieldSet,  ///< PATH=VALUE
  Material,  ///< MATERIAL: a name of the material library
  Preset     ///< PRESET: a shot of presets/, by name or path
};

struct OptionText {
  std::vector<std::string> names;    ///< "-o", "--output"; of a positional argument the word that help shows: "SHOT"
  std::string argument;              ///< "PATH=VALUE"; empty: a flag
  std::string sentence;              ///< as in --help; a default in brackets at its end
  std::string group;                 ///< heading in --help
  std::vector<std::string> choices;  ///< values that are accepted, where they are few
  ArgumentKind kind = ArgumentKind::None;
  bool positional = false;
  bool required = false;
  bool repeatable = false;  ///< takes more than one value
};

struct CommandText {
  std::string name, sentence;
  std::vector<OptionText> options;  ///< in the order of --help, positional arguments too; --help itself is left out
};

/// All commands that --help lists, in its order.
std::vector<CommandText> command_texts(const CLI::App& app);

/// Options of the program itself, before any command.
CommandText program_text(const CLI::App& app);

/// The same as JSON, for programs that read documentation or make completions of their own.
std::string command_table_json(const CLI::App& app);

/// "SHOT [options]": what stands after a command's name.
std::string synopsis(const CommandText& command);

}  // namespace softreel
