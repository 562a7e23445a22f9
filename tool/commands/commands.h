/// The subcommands of softreel. Each takes its parsed options, throws Error, and returns the exit status of its work.
#pragma once

#include <string>
#include <vector>

#include "tool/commands/session.h"
#include "tool/export/export_options.h"
#include "tool/report/studio.h"
#include "tool/stages/sheet_stage.h"

namespace softreel {

/// Simulates and renders a shot: pictures, and a movie of all its frames.
int run_render(const ShotOptions& options);

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

struct ExportOptions {
  ShotOptions shot;
  ExportWishes wishes;
};

/// Writes the deformed surfaces in the vertex order of their files.
int run_export(const ExportOptions& options);

struct PreviewOptions {
  ShotOptions shot;
  std::string mode = "shadows";  ///< fast | shadows
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
  ShotOptions shot;  ///< its `shot` is not used
  std::vector<std::string> shots;
};

/// Renders several shots, each in a process of its own; exit status 1 if one failed.
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

}  // namespace softreel
