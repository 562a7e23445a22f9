#include <chrono>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "tool/commands/commands.h"
#include "tool/stages/json_text.h"
#include "tool/stages/process.h"

namespace softreel {
namespace {

struct Outcome {
  std::string shot;
  int status = 0;
  double seconds = 0;
};

/// The command line of one shot: this very program, so that a crash of one shot cannot touch another.
std::vector<std::string> child_command(const BatchOptions& batch, const std::string& shot) {
  const ShotOptions& options = batch.shot;
  std::vector<std::string> command{"/proc/self/exe", "render", shot, "--quiet"};
  const auto add = [&](const std::string& name, const std::string& value) {
    if (!value.empty()) command.insert(command.end(), {name, value});
  };
  for (const std::string& set : options.sets) add("--set", set);
  add("--frames", options.frames);
  add("--output", options.output);
  add("--cache", options.cache);
  if (options.cache_limit_gb >= 0) add("--cache-limit", fmt::format("{}", options.cache_limit_gb));
  if (options.threads > 0) add("--threads", std::to_string(options.threads));
  return command;
}

void print_summary(const std::vector<Outcome>& outcomes, bool json, bool quiet) {
  if (json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Outcome& outcome : outcomes)
      list.push_back({{"shot", outcome.shot}, {"status", outcome.status}, {"seconds", outcome.seconds}});
    std::printf("%s\n", json_text(nlohmann::ordered_json{{"command", "batch"}, {"shots", list}}).c_str());
  } else if (!quiet) {
    for (const Outcome& outcome : outcomes)
      std::printf("  %-8s %10s  %s\n", outcome.status == 0 ? "done" : "FAILED",
                  format_duration(outcome.seconds).c_str(), outcome.shot.c_str());
  }
}

}  // namespace

int run_batch(const BatchOptions& options) {
  Console console(options.shot.quiet ? Verbosity::Quiet : Verbosity::Normal, false);
  std::vector<Outcome> outcomes;
  int failed = 0;
  for (const std::string& shot : options.shots) {
    if (options.shot.dry_run) {
      ShotOptions one = options.shot;
      one.shot = shot;
      run_plan(one);
      continue;
    }
    console.info(fmt::format("shot {} of {}: {}", outcomes.size() + 1, options.shots.size(), shot));
    const auto start = std::chrono::steady_clock::now();
    const int status = run_process(child_command(options, shot), nullptr);
    outcomes.push_back({shot, status, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
    if (status == 130 || cancellation()) throw Error(ErrorKind::Interrupt, "Interrupted; finished frames are kept.");
    failed += status == 0 ? 0 : 1;
  }
  print_summary(outcomes, options.shot.json, options.shot.quiet);
  if (failed > 0) throw work_error(fmt::format("{} of {} shots failed; the others are done.", failed, outcomes.size()));
  return 0;
}

}  // namespace softreel
