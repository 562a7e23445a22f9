#include <cstdio>
#include <filesystem>
#include <mutex>
#include <set>

#include <fmt/format.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/json_text.h"
#include "tool/commands/commands.h"
#include "tool/farm/shell_text.h"
#include "tool/starter/starter_shot.h"

namespace softreel {
namespace {

namespace fs = std::filesystem;

/// The file to write: the one named, or the mesh's name with .toml in the working directory.
std::string target_of(const NewOptions& options) {
  if (!options.output.empty()) return options.output;
  return fs::path(options.mesh).stem().string() + ".toml";
}

/// A shot that somebody has changed is not written over.
void require_free(const std::string& path, bool force) {
  std::error_code ignored;
  if (path == "-" || force || !fs::exists(fs::symlink_status(path, ignored))) return;
  throw input_error(
      fmt::format("-o {}: this file is there already, and is not touched.\n  Accepted: a name that is "
                  "free. Name another with -o, or say --force to write over it.",
                  path));
}

}  // namespace

int run_new(const NewOptions& options) {
  keep_nothing_when_interrupted();
  require_utf8(options.mesh, "the name of the mesh");  // the shot holds it, and is UTF-8
  require_utf8(options.output, "the name of the shot");
  const std::string path = target_of(options);
  require_free(path, options.force);
  Console console(Verbosity::Normal, isatty(STDERR_FILENO) != 0);
  std::set<std::string> said;
  std::mutex said_mutex;
  const Log log{{},  // facts are printed below, in order
                [&](const std::string& line) {
                  const std::lock_guard lock(said_mutex);  // the mesh is read and filled more than once
                  if (said.insert(line).second) console.warn(line);
                }};
  const Threads threads(options.threads, &cancellation());
  StageTimes times;
  const Cache cache("", Cache::Storing::Wanted, log);  // nothing is asked of it
  const RunContext context{threads, log, times, cache, cancellation()};
  StarterOptions starter;
  starter.mesh = options.mesh;
  starter.output = path == "-" ? "" : path;
  starter.material_given = !options.material.empty();
  if (starter.material_given) starter.material = options.material;
  starter.like = options.like;
  starter.wishes = {options.up, options.pin_groups, options.pull_groups, options.tets};
  const StarterShot shot = make_starter_shot(starter, context);
  if (path == "-") {
    std::printf("%s", shot.text.c_str());
    return 0;
  }
  write_file(path, shot.text);
  if (options.quiet) return 0;
  std::printf("%s: written\n", path.c_str());
  for (const std::string& fact : shot.facts) std::printf("  %s\n", fact.c_str());
  std::printf("Next: %s\n      %s\n      %s\n", shell_command({"softreel", "check", path}).c_str(),
              shell_command({"softreel", "preview", path, "--mode", "fast"}).c_str(),
              shell_command({"softreel", "render", path}).c_str());
  return 0;
}

}  // namespace softreel
