// softreel_bench: see bench.h. Started by `softreel bench`.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/benchmark/bench.h"

namespace softreel::bench {
namespace {

struct Arguments {
  BenchOptions options;
  std::string output = "out/bench";
  std::vector<const Benchmark*> chosen;
};

void print_usage(std::FILE* to) {
  fmt::print(to,
             "softreel_bench [NAME ...] [--quick] [--output DIR] [--list]\n\n"
             "Measures, and writes tables, plots and one page to DIR (default out/bench). Names, default all:\n");
  for (const Benchmark& benchmark : benchmarks()) fmt::print(to, "  {:<12} {}\n", benchmark.name, benchmark.summary);
}

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

const Benchmark& benchmark_named(const std::string& name) {
  const auto all = benchmarks();
  const auto at = std::find_if(all.begin(), all.end(), [&](const Benchmark& b) { return b.name == name; });
  if (at != all.end()) return *at;
  std::string names;
  for (const Benchmark& benchmark : all) names += std::string(names.empty() ? "" : ", ") + benchmark.name;
  throw UsageError(fmt::format("bench: {} is no benchmark; accepted: {}", name, names));
}

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto value = [&]() -> std::string {
      if (i + 1 == argc) throw UsageError(fmt::format("bench: {} needs a value", argument));
      return argv[++i];
    };
    if (argument == "--quick")
      arguments.options.quick = true;
    else if (argument == "--output")
      arguments.output = value();
    else if (argument.starts_with("-"))
      throw UsageError(fmt::format("bench: {}: accepted: --quick, --output DIR, --list", argument));
    else
      arguments.chosen.push_back(&benchmark_named(argument));
  }
  if (arguments.chosen.empty())
    for (const Benchmark& benchmark : benchmarks()) arguments.chosen.push_back(&benchmark);
  return arguments;
}

std::string command_of(int argc, char** argv) {
  std::string command = "softreel bench";
  for (int i = 1; i < argc; ++i) command += std::string(" ") + argv[i];
  return command;
}

int run(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  Report report(arguments.output, command_of(argc, argv));
  int failed = 0;
  for (const Benchmark* benchmark : arguments.chosen) {
    fmt::print("{}: {}\n", benchmark->name, benchmark->summary);
    std::fflush(stdout);
    const double start = wall_seconds();
    report.begin(benchmark->summary,
                 fmt::format("softreel bench {}{}", benchmark->name, arguments.options.quick ? " --quick" : ""));
    try {
      benchmark->run(arguments.options, report);
    } catch (const std::exception& error) {
      ++failed;
      report.fail(error.what());
      fmt::print(stderr, "bench: {}: {}\n", benchmark->name, error.what());
    }
    fmt::print("  {:.1f} s\n", wall_seconds() - start);
  }
  fmt::print("{}\n", report.finish().string());
  return failed > 0 ? 1 : 0;
}

}  // namespace
}  // namespace softreel::bench

int main(int argc, char** argv) {
  using namespace softreel::bench;
  for (int i = 1; i < argc; ++i)
    if (const std::string argument = argv[i]; argument == "--help" || argument == "-h" || argument == "--list") {
      print_usage(stdout);
      return 0;
    }
  try {
    return run(argc, argv);
  } catch (const UsageError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench: {}\n", error.what());
    return 1;
  }
}
