#include "tool/commands/shared_options.h"

#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "tool/shot/shot_load.h"

namespace softreel {

namespace {

/// A finite number that fills the text.
std::optional<double> finite_number(const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, code] = std::from_chars(text.data(), end, value);
  if (code != std::errc{} || stopped != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

CLI::Validator length(const std::string& what) {
  return {[what](std::string& text) {
            const std::optional<double> value = finite_number(text);
            return value && *value > 0 ? std::string()
                                       : fmt::format("{} is no {}. Accepted: a number above 0.", text, what);
          },
          "", what};
}

CLI::Validator size_limit() {
  return {[](std::string& text) {
            const std::optional<double> value = finite_number(text);
            return value && *value >= 0
                       ? std::string()
                       : fmt::format("{} is no size. Accepted: a number of GB from 0, which stands for no limit.",
                                     text);
          },
          "", "size"};
}

void take_one_value_each(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    for (CLI::Option* option : command->get_options())
      if (!option->get_positional()) option->allow_extra_args(false);
}

void refuse_empty_values(CLI::App& app) {
  const auto is_text = [](std::string& text) {
    return text.empty() ? std::string("the value is empty. Accepted: any other; leave the option out for its default.")
                        : std::string();
  };
  // What completes a line half typed is asked of parts that may be empty yet.
  for (CLI::App* command : app.get_subcommands([](CLI::App* one) { return one->get_name() != "completion"; }))
    for (CLI::Option* option : command->get_options())
      if (option->get_items_expected_max() > 0) option->check(CLI::Validator(is_text, "", "not_empty"));
}

void add_field_options(CLI::App& command, std::vector<std::string>& sets) {
  command.add_option("--set", sets, "set a field of the shot, e.g. body.mesh=my.obj (repeatable)")
      ->option_text("PATH=VALUE")
      ->expected(1)
      ->take_all()
      ->group("Shot");
  // After --set, whose values replace what is in the list.
  command
      .add_option_function<std::string>(
          "--quality", [&sets](const std::string& name) { sets.push_back(fmt::format("{}={}", kQuality, name)); },
          "draft | preview | final, or a TOML file: how pictures are made; its values win over the shot's own")
      ->group("Shot");
}

void add_place_options(CLI::App& command, ShotOptions& options) {
  add_field_options(command, options.sets);
  command.add_option("--output", options.output, "output folder [output.directory of the shot]")
      ->option_text("DIR")
      ->group("Files");
  command.add_option("--cache", options.cache, "folder of stored results [.cache in the output folder]")
      ->option_text("DIR")
      ->group("Files");
  command.add_option("--cache-limit", options.cache_limit_gb, "size of the cache, 0: no limit [output.cache_limit]")
      ->option_text("GB")
      ->check(size_limit())
      ->group("Files");
}

void add_run_options(CLI::App& command, ShotOptions& options) {
  add_place_options(command, options);
  command.add_option("--frames", options.frames, "frames to make: FIRST-LAST or one [all of the shot]")
      ->option_text("RANGE")
      ->group("Shot");
  command.add_option("--threads", options.threads, "number of threads, 1 to 1024 [all processors]")
      ->option_text("N")
      ->check(CLI::Range(1, 1024))
      ->group("Running");
  command.add_flag("--quiet", options.quiet, "print warnings and errors only")->group("Running");
  command.add_flag("--json", options.json, "print the closing report as JSON on standard output")->group("Running");
  command.add_flag("--dry-run", options.dry_run, "say what would be done, with memory and time; do nothing")
      ->group("Running");
}

void add_shot_options(CLI::App& command, ShotOptions& options) {
  command.add_option("shot", options.shot, "shot file (TOML)")->required()->option_text("SHOT");
  add_run_options(command, options);
}

}  // namespace softreel
