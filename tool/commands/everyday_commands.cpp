#include "tool/commands/everyday_commands.h"

#include <cstdio>

#include <CLI/CLI.hpp>

#include "tool/commands/shared_options.h"
#include "tool/report/version.h"

namespace softreel {

void add_new_command(CLI::App& app, EverydayOptions& everyday, std::function<int()>& run) {
  NewOptions& options = everyday.starting;
  CLI::App* command =
      app.add_subcommand("new", "write a shot of a mesh, with a comment for every field, that renders as it is");
  command
      ->add_option("mesh", options.mesh,
                   "surface mesh in any format assimp reads, or tetrahedra (.mesh, .msh, .vtk, .vtu)")
      ->required()
      ->option_text("MESH");
  command->add_option("-o,--output", options.output, "shot to write; -: standard output [named after the mesh]")
      ->option_text("SHOT.toml")
      ->group("Files");
  command->add_flag("--force", options.force, "write over a file that is there")->group("Files");
  command->add_option("--material", options.material, "material of the library, see presets/materials [rubber]")
      ->option_text("MATERIAL")
      ->group("Shot");
  command
      ->add_option("--like", options.like,
                   "take time, weight, light, camera and picture of a preset, or of any shot, and its material and "
                   "motion where they fit")
      ->option_text("PRESET")
      ->group("Shot");
  command->add_option("--tets", options.tets, "number of tetrahedra [20000, more where the mesh needs it]")
      ->option_text("N")
      ->check(CLI::Range(10L, 100000000L))
      ->group("Shot");
  command->add_option("--up", options.up, "x | y | z: axis of the file that points up [y, unless it stands on z]")
      ->option_text("AXIS")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->group("Shot");
  command->add_option("--pin", options.pin_groups, "group of the mesh to hold (repeatable) [its base]")
      ->option_text("GROUP")
      ->expected(1)
      ->take_all()
      ->group("Shot");
  command->add_option("--pull", options.pull_groups, "group of the mesh to pull (repeatable) [the other end]")
      ->option_text("GROUP")
      ->expected(1)
      ->take_all()
      ->group("Shot");
  command->add_option("--threads", options.threads, "number of threads, 1 to 1024 [all processors]")
      ->option_text("N")
      ->check(CLI::Range(1, 1024))
      ->group("Running");
  command->add_flag("--quiet", options.quiet, "print warnings and errors only");
  command->callback([&] { run = [&options] { return run_new(options); }; });
}

void add_reference_commands(CLI::App& app, EverydayOptions& everyday, std::function<int()>& run) {
  CLI::App* explain =
      app.add_subcommand("explain", "say what a field means, and what a shot says of it and where; or a topic");
  ExplainOptions& options = everyday.explaining;
  explain
      ->add_option("field", options.field,
                   "field, such as body.*.tets, camera.margin or tets, or a topic; without it, what there is")
      ->option_text("FIELD");
  explain->add_option("--shot", options.shot, "say its value in this shot, and the file and line it comes from")
      ->option_text("SHOT");
  add_field_options(*explain, options.sets);
  explain->add_flag("--json", options.json, "as JSON");
  explain->callback([&] { run = [&everyday] { return run_explain(everyday.explaining); }; });

  CLI::App* fields = app.add_subcommand("fields", "print the reference of all fields of a shot, as Markdown");
  fields->add_option("path", everyday.field, "explain this field instead, as softreel explain does")
      ->option_text("FIELD");
  fields->callback([&] { run = [&everyday] { return run_fields(everyday.field); }; });

  CLI::App* completion =
      app.add_subcommand("completion", "print what lets a shell complete commands, options, fields and files");
  completion
      ->add_option("shell", everyday.completion.shell,
                   "bash, zsh or fish, to be sourced; json: the table of commands and options, for other programs")
      ->check(CLI::IsMember({"bash", "zsh", "fish", "json"}))
      ->option_text("SHELL");
  completion
      ->add_option("--list", everyday.completion.list,
                   "instead, the lines that these scripts ask for: fields of --shot, values of --field, materials, "
                   "presets")
      ->check(CLI::IsMember({"fields", "values", "materials", "presets"}))
      ->option_text("WHAT");
  completion->add_option("--field", everyday.completion.field, "field whose values are listed")->option_text("FIELD");
  completion->add_option("--shot", everyday.completion.shot, "shot whose fields are listed")->option_text("SHOT");
  completion->callback([&] { run = [&app, &everyday] { return run_completion(app, everyday.completion); }; });

  CLI::App* man = app.add_subcommand("man", "print the manual page: softreel man > softreel.1; man -l softreel.1");
  man->callback([&] { run = [&app] { return run_man(app); }; });
}

void add_version_option(CLI::App& app, EverydayOptions& options) {
  CLI::Option* version =
      app.add_flag("--version", options.version, "print the version, libraries, parts and instruction set");
  app.add_flag("--json", options.json, "with --version: as JSON")->needs(version);
}

void group_commands(CLI::App& app) {
  static constexpr std::pair<const char*, const char*> kGroups[] = {
      {"check", "Look"},      {"status", "Look"}, {"inspect", "Look"},  {"explain", "Help"}, {"fields", "Help"},
      {"completion", "Help"}, {"man", "Help"},    {"bench", "Measure"}, {"clean", "Look"}};
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) command->group("Make");
  for (const auto& [name, group] : kGroups) app.get_subcommand(name)->group(group);
}

int run_version(bool json) {
  const VersionFacts facts = version_facts();
  std::printf("%s\n", (json ? to_json(facts) : to_text(facts)).c_str());
  return 0;
}

}  // namespace softreel
