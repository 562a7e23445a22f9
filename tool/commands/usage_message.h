/// What is wrong with the words of a command line.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace softreel {

/// The mistake that CLI11 found, said in full, and where to read on. A first word that is no subcommand, and an option
/// that the command does not have, get the nearest one.
std::string usage_message(const CLI::App& app, const CLI::ParseError& mistake, int argc, char** argv);

}  // namespace softreel
