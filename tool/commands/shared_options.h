/// Options that several commands share.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tool/commands/commands.h"

namespace softreel {

/// Accepts finite numbers above 0, of a length or of `what` else; CLI11's own check lets NaN pass and prints its bounds
/// with 300 digits.
CLI::Validator length(const std::string& what = "length");

/// Accepts finite numbers from 0 on, for the same reasons.
CLI::Validator size_limit();

/// What follows an option's value is the shot, also where the option may be repeated. Called when all options are
/// there.
void take_one_value_each(CLI::App& app);

/// No option of a subcommand, but for completion, takes an empty value: one that a script's unset variable left there
/// would silently stand for the default. Called when all options are there.
void refuse_empty_values(CLI::App& app);

/// --set and --quality: fields of a shot. sets are kept by reference; --quality is one of them.
void add_field_options(CLI::App& command, std::vector<std::string>& sets);

/// Where results lie, and with which fields. options are kept by reference, here and below.
void add_place_options(CLI::App& command, ShotOptions& options);

/// These, and which frames, on what, and what is said meanwhile.
void add_run_options(CLI::App& command, ShotOptions& options);

/// These, and the shot.
void add_shot_options(CLI::App& command, ShotOptions& options);

}  // namespace softreel
