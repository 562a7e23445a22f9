#include <filesystem>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/cache/process.h"
#include "tool/commands/commands.h"

namespace softreel {
namespace {

/// Beside this program, or where the build puts it; empty if it is not built.
std::filesystem::path find_bench_program() {
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  for (const char* place : {"softreel_bench", "../tests/benchmark/softreel_bench"}) {
    const std::filesystem::path path = here / place;
    if (std::filesystem::exists(path)) return path.lexically_normal();
  }
  return {};
}

}  // namespace

int run_bench(const BenchCommandOptions& options) {
  const std::filesystem::path program = find_bench_program();
  if (program.empty())
    throw input_error(
        "bench: softreel_bench is not built.\n  It is the CMake target softreel_bench, with "
        "-DSOFTREEL_BUILD_BENCHMARKS=ON; tool/run bench builds and starts it.");
  std::vector<std::string> arguments{program.string()};
  arguments.insert(arguments.end(), options.names.begin(), options.names.end());
  arguments.insert(arguments.end(), {"--output", options.output});
  if (options.quick) arguments.emplace_back("--quick");
  if (options.list) arguments.emplace_back("--list");
  const int status = run_process(arguments, nullptr);
  if (status < 0) throw work_error(fmt::format("bench: {} could not be started", program.string()));
  return status;
}

}  // namespace softreel
