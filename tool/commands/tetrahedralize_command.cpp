#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/base/error.h"
#include "core/base/timer.h"
#include "core/mesh/mesh_repair.h"
#include "core/mesh/placement.h"
#include "core/mesh/readers/mesh_import.h"
#include "core/tetmesh/cells/embedded_lattice.h"
#include "core/tetmesh/files/tet_mesh_file.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "core/tetmesh/improvement/angle_improvement.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/json_text.h"
#include "tool/commands/commands.h"
#include "tool/report/cut_picture.h"
#include "tool/shot/codecs.h"

namespace softreel {
namespace {

struct Result {
  SurfaceMesh surface;  ///< empty if tetrahedra were given
  TetMesh mesh;
  TetQuality quality;
  std::optional<SurfaceDeviation> deviation;  ///< none of given tetrahedra and whole lattice cells
  std::vector<std::string> repairs;           ///< what was done to the surface, one line each
  double seconds = 0;

  bool is_given() const { return surface.triangles.empty(); }
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

/// --error in the mesh's unit.
double parse_error_budget(const std::string& text, double diagonal) {
  if (text.empty()) return 0;
  if (const std::optional<BodyLength> length = parse_body_length(text)) return length->in_meters(diagonal);
  throw input_error(fmt::format(
      "--error {}: this is no distance.\n  Accepted: a length above 0 in the mesh's unit, or a share of the diagonal "
      "of its box above 0 and up to 50 % (0.3%). Use 0.3% if you do not know.",
      text));
}

std::string to_json(const TetrahedralizeOptions& options, const Result& result) {
  nlohmann::ordered_json json = {{"mesh", options.mesh},
                                 {"output", options.output},
                                 {"tets", result.mesh.tets.size()},
                                 {"nodes", result.mesh.nodes.size()},
                                 {"edge", result.mesh.lattice.spacing},
                                 {"volume", result.quality.volume},
                                 {"min_dihedral_deg", result.quality.min_dihedral},
                                 {"first_percentile_dihedral_deg", result.quality.first_percentile_dihedral},
                                 {"max_dihedral_deg", result.quality.max_dihedral}};
  if (!result.mesh.fill.empty()) {
    const EmbeddedFacts facts = describe_embedded(result.mesh);
    json["filled_share"] = result.quality.volume / facts.cell_volume;
    json["cut_cells"] = facts.cut_cells;
    json["copies"] = facts.copies;
  }
  if (result.deviation) {
    json["distance"] = result.deviation->two_way();
    json["distance_share_of_diagonal"] = result.deviation->two_way() / used_bounds(result.surface).diagonal();
    json["hole_share_of_boundary"] = result.deviation->cap_share;
  }
  json["repairs"] = result.repairs;
  json["seconds"] = result.seconds;
  return json_text(json);
}

/// What the sizes are: of one lattice, of several, or whatever was given.
std::string describe_sizes(const Result& result) {
  const double edge = result.mesh.lattice.spacing;
  if (edge > 0) return fmt::format("long edge {:.6g}", edge);
  return result.is_given() ? "as given" : "graded";
}

void print_text(const TetrahedralizeOptions& options, const Result& result) {
  const TetQuality& quality = result.quality;
  std::printf("%s: %zu tetrahedra, %zu nodes, %s, volume %.6g\n", options.output.c_str(), result.mesh.tets.size(),
              result.mesh.nodes.size(), describe_sizes(result).c_str(), quality.volume);
  std::printf("  dihedral angles: min %.2f, first percentile %.2f, max %.2f degrees\n", quality.min_dihedral,
              quality.first_percentile_dihedral, quality.max_dihedral);
  if (!result.mesh.fill.empty()) {
    const EmbeddedFacts facts = describe_embedded(result.mesh);
    std::printf("  embedded: filled to %.1f %%, %d cut cells, %d copies of cells\n",
                100 * quality.volume / facts.cell_volume, facts.cut_cells, facts.copies);
  }
  if (result.deviation)
    std::printf("  distance to the surface: at most %.4g (%.3f %% of the box diagonal)\n", result.deviation->two_way(),
                100 * result.deviation->two_way() / used_bounds(result.surface).diagonal());
  if (result.deviation && result.deviation->cap_share > 0)
    std::printf("  %.2g %% of the boundary closes holes and is not measured\n", 100 * result.deviation->cap_share);
  std::printf("  time: %s\n", format_duration(result.seconds).c_str());
}

/// Sizes and placement belong to surfaces.
void require_no_sizes(const TetrahedralizeOptions& options) {
  const std::pair<const char*, bool> given[] = {{"--edge", options.edge != 0},
                                                {"--tets", options.tets != 0},
                                                {"--error", !options.error.empty()},
                                                {"--graded", options.graded},
                                                {"--mode embedded", options.mode == "embedded"},
                                                {"--thickness", options.thickness != 0},
                                                {"--fit", options.fit != 0}};
  for (const auto& [name, is_given] : given)
    if (is_given)
      throw input_error(
          fmt::format("{0}: {1} holds tetrahedra already, and they are not made anew.\n  Accepted with tetrahedra: "
                      "--optimize, and -o with any format. Leave {0} out, or name a surface mesh.",
                      name, options.mesh));
}

Result take_given(const TetrahedralizeOptions& options, const Threads& threads, const Log& log) {
  require_no_sizes(options);
  Result result;
  result.mesh = read_tet_mesh(options.mesh, log);
  const auto start = std::chrono::steady_clock::now();
  if (options.optimize)
    log.info(fmt::format("{}: {}", options.mesh, describe(improve_angles(result.mesh, nullptr, {}, threads))));
  result.seconds = seconds_since(start);
  return result;
}

Result fill(const TetrahedralizeOptions& options, const Threads& threads, const Log& log) {
  Result result;
  const Log repairs{[&](const std::string& line) {
                      result.repairs.push_back(line);
                      log.info(line);
                    },
                    [&](const std::string& line) {
                      result.repairs.push_back(line);
                      log.warn(line);
                    }};
  result.surface = import_mesh(options.mesh, repairs);
  for (const std::string& line : repair_mesh(result.surface)) repairs.info(line);
  if (options.fit > 0) apply(place(result.surface, {.fit = options.fit}), result.surface);
  TetrahedralizeParams params{.edge = options.edge,
                              .tets = options.tets,
                              .error = parse_error_budget(options.error, used_bounds(result.surface).diagonal()),
                              .graded = options.graded,
                              .thickness = options.thickness,
                              .mode = options.mode == "embedded" ? TetMode::Embedded : TetMode::Conforming,
                              .optimize = options.optimize};
  if (params.edge == 0 && params.tets == 0 && params.error == 0) params.tets = 20000;
  StageTimes times;
  const auto start = std::chrono::steady_clock::now();
  result.mesh = tetrahedralize(result.surface, params, options.mesh, threads, repairs, times);
  result.seconds = seconds_since(start);
  if (params.mode == TetMode::Conforming) result.deviation = measure_deviation(result.surface, result.mesh, threads);
  return result;
}

/// Draws the picture that was asked for; said in a line of the text report.
void add_picture(const TetrahedralizeOptions& options, const TetMesh& mesh, const Threads& threads) {
  if (options.picture.path.empty()) return;
  const std::string shown = draw_cut_picture(mesh, options.picture, threads);
  if (!options.json) std::printf("  picture: %s\n", shown.c_str());
}

}  // namespace

int run_tetrahedralize(const TetrahedralizeOptions& options) {
  keep_nothing_when_interrupted();
  check_extension(options.output);
  check_cut_picture(options.picture);
  Console console(options.quiet ? Verbosity::Quiet : Verbosity::Normal, isatty(STDERR_FILENO) != 0);
  const Threads threads(options.threads);
  const bool is_given = is_tet_mesh_file(options.mesh);
  Result result = (is_given ? take_given : fill)(options, threads, console.log());
  result.quality = measure_quality(result.mesh, threads);
  const std::string extension = std::filesystem::path(options.output).extension().string();
  write_file(options.output, encode_tet_mesh(result.mesh, extension, console.log()));
  if (options.json) {
    std::printf("%s\n", to_json(options, result).c_str());
  } else {
    print_text(options, result);
  }
  add_picture(options, result.mesh, threads);
  return 0;
}

}  // namespace softreel
