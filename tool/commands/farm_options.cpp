#include "tool/commands/farm_options.h"

#include <CLI/CLI.hpp>

#include "tool/commands/shared_options.h"

namespace softreel {
namespace {

void add_work_options(CLI::App& farm, FarmOptions& options) {
  farm.add_option("shots", options.shots, "shot files (TOML)")->required()->option_text("SHOT ...");
  add_field_options(farm, options.shot.sets);
  farm.add_option("--frames", options.shot.frames, "frames to make: FIRST-LAST or one [all of the shot]")
      ->option_text("RANGE")
      ->group("Shot");
  farm.add_option("--output", options.shot.output, "output folder; all nodes share it [output.directory of the shot]")
      ->option_text("DIR")
      ->group("Files");
  farm.add_option("--cache", options.shot.cache,
                  "folder of stored results; all nodes share it [.cache in the output folder]")
      ->option_text("DIR")
      ->group("Files");
  farm.add_option("--cache-limit", options.shot.cache_limit_gb,
                  "size of the cache when the last task is done, 0: no limit [output.cache_limit]")
      ->option_text("GB")
      ->check(size_limit())
      ->group("Files");
}

void add_task_options(CLI::App& farm, FarmSettings& settings) {
  const char* const group = "Tasks";
  farm.add_option("--chunk", settings.chunk,
                  "frames of a task [about 5 minutes by the plan's estimate, 8 tasks or more]")
      ->option_text("N")
      ->check(CLI::Range(1, 1000000))
      ->group(group);
  farm.add_option("--cpus", settings.cpus, "processors of a task, and threads of softreel [2]")
      ->option_text("N")
      ->check(CLI::Range(1, 1024))
      ->group(group);
  farm.add_option("--memory", settings.memory, "memory of a task, such as 12G [twice the plan's estimate and 1G]")
      ->option_text("SIZE")
      ->group(group);
  farm.add_option("--time", settings.time,
                  "after which a task is ended: MINUTES, HOURS:MINUTES:SECONDS or DAYS-HOURS [6 times the plan's "
                  "estimate and 30 minutes]")
      ->option_text("LIMIT")
      ->group(group);
  farm.add_option("--name", settings.name, "what the jobs are called [the shot's name]")
      ->option_text("NAME")
      ->group(group);
  farm.add_option("--program", settings.program, "softreel on the nodes, the same build [this program]")
      ->option_text("FILE")
      ->group(group);
}

void add_scheduler_options(CLI::App& farm, FarmOptions& options) {
  const char* const group = "Scheduler";
  farm.add_option("--engine", options.engine,
                  "slurm: submit to Slurm; openjd: write a job template of Open Job Description 2023-09 [slurm]")
      ->check(CLI::IsMember({"slurm", "openjd"}))
      ->group(group);
  farm.add_option("--template", options.template_path, "template that openjd writes [OUTPUT/SHOT.openjd.json]")
      ->option_text("FILE")
      ->group(group);
  FarmSettings& settings = options.settings;
  farm.add_option("--partition", settings.partition, "partition of Slurm")->option_text("NAME")->group(group);
  farm.add_option("--account", settings.account, "account of Slurm")->option_text("NAME")->group(group);
  farm.add_option("--constraint", settings.constraint, "features that Slurm's nodes must have, such as avx512&bigmem")
      ->option_text("EXPRESSION")
      ->group(group);
  farm.add_option("--sbatch", settings.sbatch, "one more argument of sbatch, e.g. --sbatch=--nice=100 (repeatable)")
      ->option_text("ARGUMENT")
      ->expected(1)
      ->take_all()
      ->group(group);
}

}  // namespace

void add_farm_command(CLI::App& app, FarmOptions& options, std::function<int()>& run) {
  CLI::App* farm = app.add_subcommand(
      "farm", "give shots to a render farm: simulate, frames in chunks, movie; what is done already is left out");
  add_work_options(*farm, options);
  add_task_options(*farm, options.settings);
  add_scheduler_options(*farm, options);
  CLI::Option* status =
      farm->add_flag("--status", options.status, "say how the submitted tasks fare; status 1 if one failed")
          ->group("Running");
  CLI::Option* retry =
      farm->add_flag("--retry", options.retry, "submit again what is missing and no task in the queue makes")
          ->excludes(status)
          ->group("Running");
  farm->add_flag("--wait", options.wait,
                 "wait until all tasks are done or nothing goes on, with progress; with --status submit nothing")
      ->group("Running");
  farm->add_flag("--dry-run", options.shot.dry_run, "print what would be submitted, scripts included; do nothing")
      ->excludes(status)
      ->excludes(retry)
      ->group("Running");
  farm->add_flag("--quiet", options.shot.quiet, "print warnings and errors only")->group("Running");
  farm->add_flag("--json", options.shot.json, "print how the tasks fare as JSON on standard output")->group("Running");
  // They are asked of the record, so an option that would change it says nothing.
  for (const char* name : {"--chunk", "--cpus", "--memory", "--time", "--name", "--program", "--engine", "--template",
                           "--partition", "--account", "--constraint", "--sbatch"})
    status->excludes(farm->get_option(name));
  farm->callback([&options, &run] { run = [&options] { return run_farm(options); }; });
}

CLI::Option* add_render_part(CLI::App& render, RenderPart& part) {
  const std::map<std::string, RenderPart> parts{{"frames", RenderPart::Frames}, {"movie", RenderPart::Movie}};
  return render
      .add_option_function<std::string>(
          "--only", [&part, parts](const std::string& name) { part = parts.at(name); },
          "frames: pictures without movie and contact sheet; movie: these two, of pictures that are there [both]")
      ->check(CLI::IsMember({"frames", "movie"}))
      ->group("Shot");
}

}  // namespace softreel
