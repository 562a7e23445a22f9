/// The command farm: its options, and their place on the command line.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tool/commands/commands.h"
#include "tool/farm/farm_settings.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace softreel {

struct FarmOptions {
  ShotOptions shot;                ///< its `shot` is not used
  std::vector<std::string> shots;  ///< at least one
  FarmSettings settings;
  std::string engine;         ///< "slurm", "openjd"; empty: that of the last submission, or slurm
  std::string template_path;  ///< of openjd; empty: OUTPUT/SHOT.openjd.json
  bool status = false, retry = false, wait = false;
};

/// Gives a shot's missing work to a render farm, or says how a submission fares. Exit status 1 if a task failed, is
/// stuck or lost.
int run_farm(const FarmOptions& options);

/// Both are kept by reference.
void add_farm_command(CLI::App& app, FarmOptions& options, std::function<int()>& run);

/// --only of render.
CLI::Option* add_render_part(CLI::App& render, RenderPart& part);

}  // namespace softreel
