/// Subcommands for the first minutes and for every day: new, explain, fields, completion, man; and --version.
#pragma once

#include <functional>

#include "tool/commands/commands.h"

namespace softreel {

struct EverydayOptions {
  NewOptions starting;
  ExplainOptions explaining;
  CompletionOptions completion;
  std::string field;
  bool version = false, json = false;
};

/// Adds them; `run` becomes what the one that is given does. `app` and `options` must outlive it.
void add_new_command(CLI::App& app, EverydayOptions& options, std::function<int()>& run);
void add_reference_commands(CLI::App& app, EverydayOptions& options, std::function<int()>& run);
void add_version_option(CLI::App& app, EverydayOptions& options);

/// Headings of --help for the commands.
void group_commands(CLI::App& app);

}  // namespace softreel
