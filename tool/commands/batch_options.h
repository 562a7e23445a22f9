/// The command batch on the command line.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "tool/commands/commands.h"

namespace softreel {

/// Both are kept by reference.
void add_batch_command(CLI::App& app, BatchOptions& options, std::function<int()>& run);

}  // namespace softreel
