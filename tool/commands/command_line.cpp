#include "tool/commands/command_line.h"

#include <filesystem>
#include <functional>

#include <CLI/CLI.hpp>
#include <fmt/ranges.h>

#include "core/base/error.h"
#include "tool/commands/batch_options.h"
#include "tool/commands/commands.h"
#include "tool/commands/everyday_commands.h"
#include "tool/commands/farm_options.h"
#include "tool/commands/log_options.h"
#include "tool/commands/shared_options.h"
#include "tool/commands/usage_message.h"
#include "tool/export/formats.h"
#include "tool/report/version.h"

namespace softreel {
namespace {

constexpr const char* kFooter =
    "First steps: softreel new MESH -o SHOT.toml; softreel preview SHOT.toml; softreel render SHOT.toml.\n"
    "Options of a command: softreel COMMAND --help. Fields of a shot: softreel explain [FIELD]. Examples: presets/.\n"
    "Exit status: 0 done; 1 the work failed; 2 the input is wrong or a part is not built in; 130 after Ctrl-C.";

constexpr const char* kCommandFooter =
    "Fields: softreel explain FIELD. Exit status: 0 done; 1 the work failed; 2 the input is wrong; 130 after Ctrl-C.";

void add_picture_options(CLI::App& command, PictureOptions& options) {
  CLI::Option* picture =
      command.add_option("--picture", options.path, "picture to draw, .png; of tetrahedra what lies behind a cut")
          ->option_text("OUT.png")
          ->group("Picture");
  command
      .add_option("--cut", options.cut,
                  "x | y | z: through the middle, seen from there; -x | -y | -z: from the other side; x=0.3: at that "
                  "share of the box; X,Y,Z:NX,NY,NZ: a point and the direction to look against [x or z, whichever way "
                  "the mesh is shorter]")
      ->option_text("PLANE")
      ->needs(picture)
      ->group("Picture");
  command.add_option("--picture-size", options.size, "pixels, 16 to 8192 each [1600x1200]")
      ->option_text("WxH")
      ->needs(picture)
      ->group("Picture");
}

/// All parsed options; only those of the chosen subcommand are read.
struct Parsed {
  ShotOptions shot;
  ExportOptions exporting;
  PreviewOptions preview;
  SheetCommandOptions sheet;
  RenderPart part = RenderPart::All;
  int turntable = 0;
  GoldenOptions golden;
  BatchOptions batch;
  FarmOptions farm;
  StatusOptions status;
  CleanOptions clean;
  InspectOptions inspect;
  TetrahedralizeOptions tetrahedralize;
  BenchCommandOptions bench;
  EverydayOptions everyday;
  LogChoice log;
};

using Runner = std::function<int()>;

void add_preview_command(CLI::App& app, Parsed& parsed, Runner& run) {
  CLI::App* preview = app.add_subcommand(
      "preview",
      "draw quick lit frames and their movie with EGL, without path tracing: SHOT.preview.####.png and .mp4");
  PreviewOptions& options = parsed.preview;
  add_shot_options(*preview, options.shot);
  preview->add_option("--mode", options.mode, "shadows: with shadows and 4 samples a pixel; fast: lit only [shadows]")
      ->check(CLI::IsMember({"shadows", "fast"}))
      ->group("Picture");
  preview
      ->add_option("--gizmos", options.gizmos,
                   "marks of what holds the bodies at each frame, with commas between: pins (pink), pulls (blue, "
                   "with lines to their targets), regions (green); all; none [pins,pulls]")
      ->option_text("LIST")
      ->delimiter(',')
      ->take_all()
      ->check(CLI::IsMember({"pins", "pulls", "regions", "all", "none"}))
      ->group("Picture");
  preview
      ->add_option("--kind", options.kind,
                   "surface: the bodies; tets: their tetrahedra behind a plane, at the cut tinted by their smallest "
                   "angle, or all in the colours of render.heat [surface; tets with --cut]")
      ->check(CLI::IsMember({"surface", "tets"}))
      ->group("Picture");
  preview
      ->add_option("--cut", options.cut,
                   "of tets, through the bodies at rest: x | y | z: through the middle, seen from there; -x | -y | -z: "
                   "from the other side; x=0.3: at that share of the box; X,Y,Z:NX,NY,NZ: a point and the direction to "
                   "look against [the middle, towards the camera]")
      ->option_text("PLANE")
      ->group("Picture");
  preview->add_flag("--wireframe", options.wireframe, "draw the edges of the bodies' triangles")->group("Picture");
  preview->callback([&] { run = [&parsed] { return run_preview(parsed.preview); }; });
}

void add_export_command(CLI::App& app, Parsed& parsed, Runner& run) {
  CLI::App* exporting = app.add_subcommand("export", "write the deformed meshes, in the vertex order of their files");
  ExportWishes& wishes = parsed.exporting.wishes;
  add_shot_options(*exporting, parsed.exporting.shot);
  std::string formats = "with commas between, or repeated [obj]:";
  for (const ExportFormat& format : export_formats()) formats += fmt::format("\n{}: {}", format.name, format.about);
  exporting->add_option("--format", wishes.formats, formats)
      ->option_text("LIST")
      ->delimiter(',')
      ->take_all()
      ->group("Files");
  exporting->add_option("--space", wishes.space, "object (the file's own) | world [object]")
      ->option_text("SPACE")
      ->group("Files");
  exporting
      ->add_option("--unit", wishes.unit,
                   "unit of the exported world: m | cm | mm | in | ft, or the metres of one unit [m]")
      ->option_text("UNIT")
      ->group("Files");
  exporting->add_option("--up", wishes.up, "axis of the exported world that points up: y | z [y]")
      ->option_text("AXIS")
      ->group("Files");
  exporting->add_option("--fps", wishes.fps, "frames a second at which it plays, above 0 [shot.fps]")
      ->option_text("RATE")
      ->check(length("rate"))
      ->group("Files");
  exporting
      ->add_option("--subframes", wishes.subframes,
                   "samples between two frames, 0 to 99, on straight lines between the steps of the simulation [0]")
      ->option_text("N")
      ->check(CLI::Range(0, 99))
      ->group("Files");
  exporting->add_flag("--normals", wishes.normals, "normals of the vertices too")->group("Files");
  exporting->add_option("--voxel", wishes.voxel, "of vdb: edge of a voxel in the exported unit [1/160 of the body]")
      ->option_text("EDGE")
      ->check(length("edge"))
      ->group("Files");
  exporting->callback([&] { run = [&parsed] { return run_export(parsed.exporting); }; });
}

void add_making_commands(CLI::App& app, Parsed& parsed, Runner& run) {
  CLI::App* render = app.add_subcommand("render", "simulate a shot and trace its pictures and movie");
  add_shot_options(*render, parsed.shot);
  render
      ->add_option("--turntable", parsed.turntable,
                   "instead of the shot, N pictures of its first frame (or of --frames N) from all round: the camera "
                   "turns about the vertical through its target; SHOT.turntable.####.png and .mp4")
      ->option_text("N")
      ->check(CLI::Range(1, 10000))
      ->excludes(render->get_option("--dry-run"))
      ->group("Shot");
  CLI::Option* only = add_render_part(*render, parsed.part);
  only->excludes(render->get_option("--turntable"))->excludes(render->get_option("--dry-run"));
  render->callback([&] {
    run = [&parsed] {
      return parsed.turntable > 0 ? run_turntable(parsed.shot, parsed.turntable) : run_render(parsed.shot, parsed.part);
    };
  });

  CLI::App* sheet =
      app.add_subcommand("sheet", "render some frames, and write small pictures of them on one: SHOT.sheet.png");
  add_shot_options(*sheet, parsed.sheet.shot);
  sheet->add_option("--count", parsed.sheet.sheet.count, "pictures at most, equally far apart in time [16]")
      ->check(CLI::Range(1, 1000))
      ->group("Shot");
  sheet->add_option("--columns", parsed.sheet.sheet.columns, "pictures side by side [4]")
      ->check(CLI::Range(1, 100))
      ->group("Shot");
  sheet->callback([&] { run = [&parsed] { return run_sheet(parsed.sheet); }; });

  CLI::App* simulate = app.add_subcommand("simulate", "simulate a shot into its cache, without pictures");
  add_shot_options(*simulate, parsed.shot);
  simulate->callback([&] { run = [&parsed] { return run_simulate(parsed.shot); }; });

  add_export_command(app, parsed, run);
  add_preview_command(app, parsed, run);

  CLI::App* golden = app.add_subcommand(
      "golden", "render shots at test quality and compare them with golden images; status 1 on change");
  golden->add_option("shots", parsed.golden.shots, "shot files (TOML)")->required()->option_text("SHOT ...");
  add_run_options(*golden, parsed.golden.shot);
  golden->add_option("--reference", parsed.golden.reference, "folder of golden images [golden beside each shot]")
      ->option_text("DIR")
      ->group("Files");
  golden
      ->add_flag("--update", parsed.golden.update,
                 "make the rendered frames the golden ones, with a record of their geometry")
      ->group("Running");
  golden->callback([&] { run = [&parsed] { return run_golden(parsed.golden); }; });

  add_batch_command(app, parsed.batch, run);
}

void add_looking_commands(CLI::App& app, Parsed& parsed, Runner& run) {
  CLI::App* check = app.add_subcommand("check", "read a shot, its meshes and selections, and say what they hold");
  add_shot_options(*check, parsed.shot);
  check->callback([&] { run = [&parsed] { return run_check(parsed.shot); }; });

  CLI::App* status = app.add_subcommand("status", "say what of a shot is done, stale and why, missing or damaged");
  status->add_option("shot", parsed.status.shot.shot, "shot file (TOML)")->required()->option_text("SHOT");
  add_place_options(*status, parsed.status.shot);
  status->add_flag("--json", parsed.status.shot.json, "as JSON")->group("Running");
  status->add_flag("--exit-code", parsed.status.exit_code, "status 1 unless everything is done")->group("Running");
  status->callback([&] { run = [&parsed] { return run_status(parsed.status); }; });

  CLI::App* clean = app.add_subcommand("clean", "remove stored results that the shot as it is now does not need");
  clean->add_option("shot", parsed.clean.shot.shot, "shot file (TOML)")->option_text("SHOT");
  add_place_options(*clean, parsed.clean.shot);
  clean->add_flag("--all", parsed.clean.all, "remove everything that no running job needs")->group("Running");
  clean->add_flag("--dry-run", parsed.clean.shot.dry_run, "only say what would be removed")->group("Running");
  clean->callback([&] { run = [&parsed] { return run_clean(parsed.clean); }; });
}

void add_mesh_commands(CLI::App& app, Parsed& parsed, Runner& run) {
  CLI::App* inspect =
      app.add_subcommand("inspect", "say what is in a mesh: size, holes, flips, pieces; of tetrahedra their angles");
  inspect
      ->add_option("mesh", parsed.inspect.mesh,
                   "surface mesh in any format assimp reads, or tetrahedra: .mesh (Medit), .msh (Gmsh), .vtk, .vtu")
      ->required()
      ->option_text("MESH");
  inspect->add_option("--surface", parsed.inspect.surface, "of tetrahedra: measure their distance to this surface")
      ->option_text("MESH");
  inspect->add_option("--threads", parsed.inspect.threads, "number of threads [all processors]")
      ->check(CLI::Range(1, 1024));
  inspect->add_flag("--json", parsed.inspect.json, "as JSON");
  add_picture_options(*inspect, parsed.inspect.picture);
  inspect->callback([&] { run = [&parsed] { return run_inspect(parsed.inspect); }; });

  CLI::App* tets = app.add_subcommand("tetrahedralize", "fill a surface with tetrahedra and write them");
  TetrahedralizeOptions& options = parsed.tetrahedralize;
  tets->add_option("mesh", options.mesh,
                   "surface mesh in any format assimp reads, or tetrahedra (.mesh, .msh, .vtk, .vtu) to optimize or to "
                   "write in another format")
      ->required()
      ->option_text("MESH");
  tets->add_option("-o,--output", options.output, "file to write: .vtu, .msh (Gmsh 2.2) or .mesh (Medit)")
      ->required()
      ->option_text("OUT.vtu");
  CLI::Option* edge =
      tets->add_option("--edge", options.edge, "long edge of the lattice, in the mesh's unit")->check(length());
  CLI::Option* count = tets->add_option("--tets", options.tets, "number of tetrahedra, met within 5 % [20000]")
                           ->check(CLI::Range(10L, 100000000L))
                           ->excludes(edge);
  CLI::Option* error = tets->add_option("--error", options.error,
                                        "distance to the surface to keep to: in the mesh's unit, or as 0.3% of its "
                                        "box's diagonal; always graded")
                           ->excludes(edge)
                           ->excludes(count);
  tets->add_flag("--graded", options.graded,
                 "with --tets: fine where the surface asks for it and coarse inside; with --edge: coarse inside only")
      ->excludes(error);
  tets->add_option(
          "--mode", options.mode,
          "conforming: the boundary follows the surface; embedded: whole lattice tetrahedra, weighted by their "
          "fill [conforming]")
      ->check(CLI::IsMember({"conforming", "embedded"}));
  tets->add_option("--thickness", options.thickness, "make open sheets this thick, in the mesh's unit after fit")
      ->check(length());
  tets->add_option("--fit", options.fit, "scale the mesh to this height first, m")->check(length());
  tets->add_flag("--optimize", options.optimize, "make the worst dihedral angles better by moving nodes and by flips");
  tets->add_option("--threads", options.threads, "number of threads [all processors]")->check(CLI::Range(1, 1024));
  tets->add_flag("--quiet", options.quiet, "print warnings and errors only");
  tets->add_flag("--json", options.json, "print the report as JSON");
  add_picture_options(*tets, options.picture);
  tets->callback([&] { run = [&parsed] { return run_tetrahedralize(parsed.tetrahedralize); }; });
}

void add_bench_command(CLI::App& app, Parsed& parsed, Runner& run) {
  CLI::App* bench =
      app.add_subcommand("bench", "measure run time against error beside rivals, and stability; a report");
  BenchCommandOptions& options = parsed.bench;
  bench->add_option("names", options.names, "sub-benchmarks [all; see --list]")->option_text("NAME ...");
  bench->add_flag("--quick", options.quick, "smaller meshes, fewer seeds: within 3 minutes");
  bench->add_flag("--list", options.list, "print the sub-benchmarks and measure nothing");
  bench->add_option("--output", options.output, "folder for tables, plots and index.html [out/bench]")
      ->option_text("DIR");
  bench->callback([&] { run = [&parsed] { return run_bench(parsed.bench); }; });
}

/// What is run, and where, for logs.
void say_command(int argc, char** argv) {
  std::error_code ignored;
  Console(Verbosity::Normal, false)
      .debug(fmt::format("{}; in {}: {}", version_text(), std::filesystem::current_path(ignored).string(),
                         fmt::join(std::vector<std::string>(argv, argv + argc), " ")));
}

}  // namespace

int run_command_line(int argc, char** argv) {
  CLI::App app(
      "softreel fills surface meshes with tetrahedra, deforms them under keyed pins and pulls, and renders them.",
      "softreel");
  app.footer(kCommandFooter);  // which the subcommands take over
  app.require_subcommand(0, 1);
  Parsed parsed;
  Runner run;
  add_version_option(app, parsed.everyday);
  add_new_command(app, parsed.everyday, run);
  add_making_commands(app, parsed, run);
  add_farm_command(app, parsed.farm, run);
  add_looking_commands(app, parsed, run);
  add_mesh_commands(app, parsed, run);
  add_reference_commands(app, parsed.everyday, run);
  add_bench_command(app, parsed, run);
  group_commands(app);
  add_log_options(app, parsed.log);
  take_one_value_each(app);
  refuse_empty_values(app);
  app.footer(kFooter);
  try {
    app.parse(argc, argv);
    if (!parsed.everyday.version && app.get_subcommands().empty()) throw CLI::RequiredError("A subcommand");
  } catch (const CLI::Success& request) {  // --help
    return app.exit(request);
  } catch (const CLI::ParseError& mistake) {
    throw input_error(usage_message(app, mistake, argc, argv));
  }
  if (parsed.everyday.version) return run_version(parsed.everyday.json);
  apply_log_options(*app.get_subcommands().front(), parsed.log);
  say_command(argc, argv);
  return run();
}

}  // namespace softreel
