#include "tool/commands/log_options.h"

#include <cstdlib>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/report/console.h"

namespace softreel {
namespace {

constexpr const char* kGroup = "Messages";

LogLevel level_of_environment() {
  const char* said = std::getenv("SOFTREEL_LOG");
  if (said == nullptr || *said == '\0') return LogLevel::Info;
  if (const auto level = level_named(said)) return *level;
  throw input_error(
      fmt::format("SOFTREEL_LOG={}: there is no such level.\n  Accepted: error, warning, info, debug. Correct the "
                  "environment variable, or unset it.",
                  said));
}

}  // namespace

void add_log_options(CLI::App& app, LogChoice& choice) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    CLI::Option* quiet = command->get_option_no_throw("--quiet");
    if (quiet == nullptr) quiet = command->add_flag("--quiet", choice.quiet, "print warnings and errors only");
    quiet->group(kGroup);
    command->add_flag("--verbose", choice.verbose, "say more: files, folders, settings and times")->group(kGroup);
    command
        ->add_option("--log-level", choice.level,
                     "error | warning (as --quiet) | info | debug (as --verbose) [SOFTREEL_LOG, else info]")
        ->check(CLI::IsMember({"error", "warning", "info", "debug"}))
        ->option_text("LEVEL")
        ->group(kGroup);
    command
        ->add_option("--log-file", choice.file, "add messages of all levels, with date and time, to the end of a file")
        ->option_text("FILE")
        ->group(kGroup);
  }
}

void apply_log_options(CLI::App& command, const LogChoice& choice) {
  CLI::Option* quiet = command.get_option_no_throw("--quiet");
  const bool is_quiet = quiet != nullptr && quiet->count() > 0;
  if (int{is_quiet} + int{choice.verbose} + int{!choice.level.empty()} > 1)
    throw input_error(
        "--quiet, --verbose, --log-level: more than one is given.\n  Accepted: one of them. Leave the others out.");
  LogLevel level = LogLevel::Info;
  if (!choice.level.empty())
    level = *level_named(choice.level);
  else if (choice.verbose)
    level = LogLevel::Debug;
  else if (is_quiet)
    level = LogLevel::Warning;
  else
    level = level_of_environment();
  if (level < LogLevel::Info && quiet != nullptr && quiet->count() == 0) {
    quiet->add_result("true");
    quiet->run_callback();
  }
  set_log_output({level, choice.file});
}

}  // namespace softreel
