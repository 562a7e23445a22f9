#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/base/error.h"
#include "core/mesh/mesh_repair.h"
#include "core/mesh/placement.h"
#include "core/mesh/readers/mesh_import.h"
#include "core/tetmesh/tet_mesh_file.h"
#include "core/tetmesh/tet_quality.h"
#include "core/tetmesh/tetrahedralize.h"
#include "tool/commands/commands.h"
#include "tool/stages/atomic_file.h"

namespace softreel {
namespace {

struct Result {
  SurfaceMesh surface;
  TetMesh mesh;
  TetQuality quality;
  SurfaceDeviation deviation;
  double seconds = 0;
};

/// A format that cannot be written is said before the work.
void check_extension(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".vtu" || extension == ".msh" || extension == ".mesh") return;
  throw input_error(
      fmt::format("-o {}: the format \"{}\" is not known.\n  Accepted: .vtu (VTK), .msh (Gmsh 2.2), "
                  ".mesh (Medit).",
                  path, extension));
}

/// --error in metres: a number, or a share of the diagonal with a % sign.
double parse_error_budget(const std::string& text, double diagonal) {
  if (text.empty()) return 0;
  const bool is_share = text.back() == '%';
  const char* const end = text.data() + text.size() - (is_share ? 1 : 0);
  double value = 0;
  const auto [stopped, code] = std::from_chars(text.data(), end, value);
  if (code != std::errc{} || stopped != end || !(value > 0) || !std::isfinite(value) || (is_share && value > 50))
    throw input_error(fmt::format(
        "--error {}: this is no distance.\n  Accepted: a length above 0 in the mesh's unit, or a share of the diagonal "
        "of its box above 0 and up to 50 % (0.3%). Use 0.3% if you do not know.",
        text));
  return is_share ? value / 100 * diagonal : value;
}

std::string to_json(const TetrahedralizeOptions& options, const Result& result) {
  const double diagonal = used_bounds(result.surface).diagonal();
  const nlohmann::ordered_json json = {{"mesh", options.mesh},
                                       {"output", options.output},
                                       {"tets", result.mesh.tets.size()},
                                       {"nodes", result.mesh.nodes.size()},
                                       {"edge", result.mesh.lattice.spacing},
                                       {"volume", result.quality.volume},
                                       {"min_dihedral_deg", result.quality.min_dihedral},
                                       {"first_percentile_dihedral_deg", result.quality.first_percentile_dihedral},
                                       {"max_dihedral_deg", result.quality.max_dihedral},
                                       {"distance", result.deviation.two_way()},
                                       {"distance_share_of_diagonal", result.deviation.two_way() / diagonal},
                                       {"seconds", result.seconds}};
  return json.dump(1);
}

void print_text(const TetrahedralizeOptions& options, const Result& result) {
  const TetQuality& quality = result.quality;
  const double edge = result.mesh.lattice.spacing;
  std::printf("%s: %zu tetrahedra, %zu nodes, %s, volume %.6g\n", options.output.c_str(), result.mesh.tets.size(),
              result.mesh.nodes.size(), edge > 0 ? fmt::format("long edge {:.6g}", edge).c_str() : "graded",
              quality.volume);
  std::printf("  dihedral angles: min %.2f, first percentile %.2f, max %.2f degrees\n", quality.min_dihedral,
              quality.first_percentile_dihedral, quality.max_dihedral);
  std::printf("  distance to the surface: at most %.4g (%.3f %% of the box diagonal)\n", result.deviation.two_way(),
              100 * result.deviation.two_way() / used_bounds(result.surface).diagonal());
  std::printf("  time: %s\n", format_duration(result.seconds).c_str());
}

}  // namespace

int run_tetrahedralize(const TetrahedralizeOptions& options) {
  check_extension(options.output);
  Console console(options.quiet ? Verbosity::Quiet : Verbosity::Normal, isatty(STDERR_FILENO) != 0);
  const Log log = console.log();
  const Threads threads(options.threads);
  StageTimes times;
  Result result;
  result.surface = import_mesh(options.mesh, log);
  for (const std::string& line : repair_mesh(result.surface)) log.info(line);
  if (options.fit > 0) apply(place(result.surface, {.fit = options.fit}), result.surface);
  TetrahedralizeParams params{.edge = options.edge,
                              .tets = options.tets,
                              .error = parse_error_budget(options.error, used_bounds(result.surface).diagonal()),
                              .graded = options.graded,
                              .thickness = options.thickness};
  if (params.edge == 0 && params.tets == 0 && params.error == 0) params.tets = 20000;
  const auto start = std::chrono::steady_clock::now();
  result.mesh = tetrahedralize(result.surface, params, options.mesh, threads, log, times);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.quality = measure_quality(result.mesh, threads);
  result.deviation = measure_deviation(result.surface, result.mesh, threads);
  write_file(options.output, encode_tet_mesh(result.mesh, std::filesystem::path(options.output).extension().string()));
  if (options.json) {
    std::printf("%s\n", to_json(options, result).c_str());
  } else {
    print_text(options, result);
  }
  return 0;
}

}  // namespace softreel
