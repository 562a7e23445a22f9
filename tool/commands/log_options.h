/// How much is said, and where to: the options that every command has.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace softreel {

struct LogChoice {
  bool quiet = false, verbose = false;
  std::string level, file;
};

/// Adds --quiet, --verbose, --log-level and --log-file to every subcommand of the program; a --quiet that a command has
/// already stays its own. `choice` must outlive the parser.
void add_log_options(CLI::App& app, LogChoice& choice);

/// After parsing: sets what the process shows (tool/report/console.h), by the options of the command that was given,
/// else by the environment variable SOFTREEL_LOG, else "info". Below "info" a command's own --quiet is set, so that it
/// keeps its closing report to itself. Throws input_error for two options that say different things and for a level in
/// the variable that does not exist, work_error if the log file cannot be opened.
void apply_log_options(CLI::App& command, const LogChoice& choice);

}  // namespace softreel
