/// The subcommands of softreel. Each takes its parsed options, throws Error, and returns the exit status of its work.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tool/commands/session.h"
#include "tool/export/export_options.h"
#include "tool/report/studio.h"
#include "tool/stages/sheet_stage.h"

namespace CLI {
class App;
}

namespace softreel {

/// What of a shot's files is made: a farm makes frames at several places, and then the rest at one.
enum class RenderPart {
  All,
  Frames,  ///< pictures only
  Movie    ///< movie and contact sheet, from pictures that are there
};

/// Simulates and renders a shot: pictures, and a movie of all its frames.
int run_render(const ShotOptions& options, RenderPart part = RenderPart::All);

/// Makes movie and contact sheet of finished pictures; throws work_error, naming the frames, if pictures are missing.
int run_movie(const ShotOptions& options);

/// Renders the first of the frames asked for from `count` places on a circle round what the camera looks at.
int run_turntable(const ShotOptions& options, int count);

struct SheetCommandOptions {
  ShotOptions shot;
  SheetOptions sheet;
};

/// Renders some frames of a shot and puts small pictures of them on one.
int run_sheet(const SheetCommandOptions& options);

/// Simulates a shot into the cache.
int run_simulate(const ShotOptions& options);

/// Prints what run_render would do, with the memory and time it should take.
int run_plan(const ShotOptions& options);

/// What a command would make of bodies at some frames, beside pictures.
struct PlannedWork {
  std::vector<int> frames;          ///< at which they are needed, from the first on
  std::vector<std::string> lines;   ///< for people
  int missing = 0, of = 0;          ///< files; of = 0: none are made
  std::optional<int> outdated = 0;  ///< files that would be removed; none: only the work itself finds out
};

/// The same of another command than run_render.
int run_plan(const ShotOptions& options, const std::function<PlannedWork(ShotRun&, Outputs&)>& find_work);

struct ExportOptions {
  ShotOptions shot;
  ExportWishes wishes;
};

/// Writes the deformed surfaces in the vertex order of their files.
int run_export(const ExportOptions& options);

struct PreviewOptions {
  ShotOptions shot;
  std::string mode = "shadows";  ///< fast | shadows
  std::string kind;              ///< surface | tets; empty: tets if there is a cut
  std::string cut;               ///< see cut_plane in tool/report/cut_plane.h; empty: chosen
  bool wireframe = false;
  std::vector<std::string> gizmos = {"pins", "pulls"};  ///< of pins, pulls, regions; or all, or none
};

/// Draws frames by rasterisation, without path tracing, and a movie of all of the shot's.
int run_preview(const PreviewOptions& options);

struct GoldenOptions {
  ShotOptions shot;                ///< its `shot` is not used
  std::vector<std::string> shots;  ///< at least one
  std::string reference;           ///< folder of the golden images; empty: "golden" beside each shot
  bool update = false;
};

/// Renders the golden frames and compares them; exit status 1 if one changed.
int run_golden(const GoldenOptions& options);

struct BatchOptions {
  ShotOptions shot;  ///< its `shot` is not used; its threads are those of all running jobs together
  std::vector<std::string> shots;
  std::vector<std::string> sweeps;             ///< "path=value,value,..."
  std::string report;                          ///< folder; empty: where the shots' files go
  int jobs = 0;                                ///< at one time; 0: by processors and memory
  double memory_gb = 0;                        ///< of all running jobs together; 0: what the machine has left
  int retries = 0;                             ///< of a job that crashed
  bool fail_fast = false, keep_going = false;  ///< the second is the default, and may be said
};

/// Renders several shots, and variants of them, each in a process of its own; exit status 1 if one failed.
int run_batch(const BatchOptions& options);

/// Reads a shot, its meshes and selections, and says what they hold.
int run_check(const ShotOptions& options);

struct StatusOptions {
  ShotOptions shot;
  bool exit_code = false;  ///< status 1 unless everything is done
};

/// Says what of a shot is done, stale and why, missing or damaged.
int run_status(const StatusOptions& options);

struct CleanOptions {
  ShotOptions shot;  ///< its `shot` may be empty
  bool all = false;
};

/// Removes stored results that nothing needs any more.
int run_clean(const CleanOptions& options);

struct InspectOptions {
  std::string mesh;
  std::string surface;  ///< that tetrahedra are to follow; empty: their distance to it is not measured
  PictureOptions picture;
  int threads = 0;
  bool json = false;
};

/// Says what is in a surface mesh or in tetrahedra, and draws them if asked.
int run_inspect(const InspectOptions& options);

struct TetrahedralizeOptions {
  std::string mesh, output, error, mode = "conforming";
  double edge = 0, fit = 0, thickness = 0;
  long tets = 0;
  int threads = 0;
  bool graded = false, optimize = false, quiet = false, json = false;
  PictureOptions picture;
};

/// Fills a surface, writes the tetrahedra, and draws them if asked; given tetrahedra are only optimized, drawn, or
/// written in another format.
int run_tetrahedralize(const TetrahedralizeOptions& options);

struct BenchCommandOptions {
  std::vector<std::string> names;  ///< of sub-benchmarks; empty: all
  std::string output = "out/bench";
  bool quick = false, list = false;
};

/// Starts softreel_bench, which rivals' libraries are linked to and this program is not; returns its exit status.
int run_bench(const BenchCommandOptions& options);

struct NewOptions {
  std::string mesh, output;  ///< output: the shot; empty: named after the mesh; "-": standard output
  std::string material, like, up;
  std::vector<std::string> pin_groups, pull_groups;
  long tets = 0;
  int threads = 0;
  bool force = false, quiet = false;
};

/// Writes a commented shot of a mesh.
int run_new(const NewOptions& options);

struct ExplainOptions {
  std::string field, shot;
  std::vector<std::string> sets;
  bool json = false;
};

/// Says what a field or a topic means, and what a shot says of the field; without a field, what there is to ask.
int run_explain(const ExplainOptions& options);

/// Prints the reference of all fields, or explains one.
int run_fields(const std::string& path);

struct CompletionOptions {
  std::string shell;              ///< bash | zsh | fish | json
  std::string list, field, shot;  ///< what the scripts ask while a line is typed
};

/// Prints the completion of a shell from the table of commands.
int run_completion(const CLI::App& app, const CompletionOptions& options);

/// Prints the manual page from the table of commands.
int run_man(const CLI::App& app);

/// Prints the version, the libraries, the parts and the machine.
int run_version(bool json);

}  // namespace softreel
