#include <cstdio>
#include <string>

#include "core/base/error.h"
#include "tool/commands/commands.h"
#include "tool/help/completion.h"
#include "tool/help/man_page.h"
#include "tool/report/version.h"
#include "tool/shot/preset_library.h"

namespace softreel {
namespace {

/// What a script asks for while somebody types: lines, and nothing that could disturb the line that is being typed.
std::vector<std::string> asked(const CompletionOptions& options) {
  if (options.list == "fields") return settable_fields(options.shot);
  if (options.list == "values") return field_values(options.field, options.shot);
  return options.list == "materials" ? library_materials() : library_presets();
}

std::string script(const CLI::App& app, const std::string& shell) {
  if (shell == "json") return command_table_json(app) + "\n";
  const auto write = shell == "bash" ? bash_completion : shell == "zsh" ? zsh_completion : fish_completion;
  return write(command_texts(app), program_text(app));
}

}  // namespace

int run_completion(const CLI::App& app, const CompletionOptions& options) {
  if (!options.list.empty()) {
    for (const std::string& line : asked(options)) std::printf("%s\n", line.c_str());
    return 0;
  }
  if (options.shell.empty())
    throw input_error(
        "completion: no shell is named.\n  Accepted: bash, zsh, fish, or json for the table of commands.");
  std::printf("%s", script(app, options.shell).c_str());
  return 0;
}

int run_man(const CLI::App& app) {
  std::printf("%s", man_page(app, short_version()).c_str());
  return 0;
}

}  // namespace softreel
