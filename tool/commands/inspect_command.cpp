#include <algorithm>
#include <cstdio>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/base/error.h"
#include "core/mesh/mesh_check.h"
#include "core/mesh/mesh_repair.h"
#include "core/mesh/readers/mesh_import.h"
#include "core/tetmesh/files/tet_mesh_file.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "tool/cache/json_text.h"
#include "tool/commands/commands.h"
#include "tool/report/cut_picture.h"
#include "tool/report/surface_picture.h"

namespace softreel {
namespace {

std::string facts_json(const InspectOptions& options, const MeshFacts& facts, const SurfaceMesh& mesh,
                       const std::vector<std::string>& repairs) {
  nlohmann::ordered_json groups = nlohmann::ordered_json::array();
  for (const VertexGroup& group : mesh.groups)
    groups.push_back({{"name", group.name}, {"vertices", group.vertices.size()}});
  const auto list = [](const Vec3& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  const nlohmann::ordered_json json = {{"mesh", options.mesh},
                                       {"vertices", facts.vertices},
                                       {"used_vertices", facts.used_vertices},
                                       {"distinct_vertices", facts.distinct_vertices},
                                       {"polygons", mesh.polygons.size()},
                                       {"triangles", facts.triangles},
                                       {"boundary_edges", facts.boundary_edges},
                                       {"holes", facts.holes},
                                       {"non_manifold_edges", facts.non_manifold_edges},
                                       {"flipped_neighbours", facts.flipped_neighbours},
                                       {"duplicate_triangles", facts.duplicate_triangles},
                                       {"collapsed_triangles", facts.collapsed_triangles},
                                       {"pieces", facts.pieces},
                                       {"not_finite", facts.not_finite},
                                       {"signed_volume", facts.signed_volume},
                                       {"min", list(facts.bounds.min)},
                                       {"max", list(facts.bounds.max)},
                                       {"groups", groups},
                                       {"repairs", repairs}};
  return json_text(json);
}

/// What is in a file of tetrahedra.
struct TetFacts {
  TetMesh mesh;
  TetQuality quality;
  Bounds box;
  std::optional<SurfaceDeviation> deviation;  ///< from the surface that was named
  double diagonal = 0;                        ///< of that surface's box
  std::size_t boundary_faces = 0;
  Index pieces = 0;
};

TetFacts read_tets(const InspectOptions& options, const Log& log) {
  const Threads threads(options.threads);
  TetFacts facts;
  facts.mesh = read_tet_mesh(options.mesh, log);
  facts.quality = measure_quality(facts.mesh, threads);
  if (!options.surface.empty()) {
    SurfaceMesh surface = import_mesh(options.surface, log);
    repair_mesh(surface);
    facts.deviation = measure_deviation(surface, facts.mesh, threads);
    facts.diagonal = used_bounds(surface).diagonal();
  }
  for (const Vec3& p : facts.mesh.nodes) facts.box.add(p);
  facts.boundary_faces = find_boundary(facts.mesh).size();
  for (const Index piece : face_connected_pieces(facts.mesh)) facts.pieces = std::max(facts.pieces, piece + 1);
  return facts;
}

void print_tets_json(const InspectOptions& options, const TetFacts& facts) {
  const auto list = [](const Vec3& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  nlohmann::ordered_json json = {{"mesh", options.mesh},
                                 {"tets", facts.mesh.tets.size()},
                                 {"nodes", facts.mesh.nodes.size()},
                                 {"boundary_faces", facts.boundary_faces},
                                 {"pieces", facts.pieces},
                                 {"volume", facts.quality.volume},
                                 {"min_volume", facts.quality.min_volume},
                                 {"min_dihedral_deg", facts.quality.min_dihedral},
                                 {"first_percentile_dihedral_deg", facts.quality.first_percentile_dihedral},
                                 {"max_dihedral_deg", facts.quality.max_dihedral},
                                 {"min", list(facts.box.min)},
                                 {"max", list(facts.box.max)}};
  if (facts.deviation) {
    json["distance"] = facts.deviation->two_way();
    json["distance_share_of_diagonal"] = facts.deviation->two_way() / facts.diagonal;
    json["hole_share_of_boundary"] = facts.deviation->cap_share;
  }
  std::printf("%s\n", json_text(json).c_str());
}

void print_tets_text(const InspectOptions& options, const TetFacts& facts) {
  const Vec3 size = facts.box.size();
  std::printf("%s: %zu tetrahedra, %zu nodes, %zu boundary faces; box %.6g x %.6g x %.6g\n", options.mesh.c_str(),
              facts.mesh.tets.size(), facts.mesh.nodes.size(), facts.boundary_faces, size.x(), size.y(), size.z());
  std::printf("  pieces connected through faces: %d\n", facts.pieces);
  std::printf("  volume %.6g, smallest element %.3g\n", facts.quality.volume, facts.quality.min_volume);
  std::printf("  dihedral angles: min %.2f, first percentile %.2f, max %.2f degrees\n", facts.quality.min_dihedral,
              facts.quality.first_percentile_dihedral, facts.quality.max_dihedral);
  if (facts.deviation)
    std::printf("  distance to %s: at most %.4g (%.3f %% of the box diagonal)\n", options.surface.c_str(),
                facts.deviation->two_way(), 100 * facts.deviation->two_way() / facts.diagonal);
  if (facts.deviation && facts.deviation->cap_share > 0)
    std::printf("  %.2g %% of the boundary closes holes and is not measured\n", 100 * facts.deviation->cap_share);
}

void print_shown(const InspectOptions& options, const std::string& shown) {
  if (!options.json) std::printf("  picture: %s\n", shown.c_str());
}

int inspect_tets(const InspectOptions& options, const Log& log) {
  check_cut_picture(options.picture);
  const TetFacts facts = read_tets(options, log);
  options.json ? print_tets_json(options, facts) : print_tets_text(options, facts);
  if (!options.picture.path.empty())
    print_shown(options, draw_cut_picture(facts.mesh, options.picture, Threads(options.threads)));
  return 0;
}

void print_facts_text(const InspectOptions& options, const MeshFacts& facts, const SurfaceMesh& mesh,
                      const std::vector<std::string>& repairs) {
  const Vec3 size = facts.bounds.size();
  std::printf("%s: %zu polygons; box %.6g x %.6g x %.6g from (%.6g, %.6g, %.6g)\n", options.mesh.c_str(),
              mesh.polygons.size(), size.x(), size.y(), size.z(), facts.bounds.min.x(), facts.bounds.min.y(),
              facts.bounds.min.z());
  for (const std::string& line : describe(facts)) std::printf("  %s\n", line.c_str());
  for (const std::string& line : repairs) std::printf("  a shot would repair: %s\n", line.c_str());
  for (const VertexGroup& group : mesh.groups)
    std::printf("  group \"%s\": %zu vertices\n", group.name.c_str(), group.vertices.size());
}

void check_surface_options(const InspectOptions& options) {
  check_picture(options.picture);
  if (!options.surface.empty())
    throw input_error(
        fmt::format("--surface {}: {} is a surface itself.\n  Accepted: --surface with tetrahedra (.mesh, .msh, .vtk, "
                    ".vtu). Leave it out.",
                    options.surface, options.mesh));
  if (!options.picture.cut.empty())
    throw input_error(
        fmt::format("--cut {}: {} is a surface, which has no inside to show.\n  Accepted: --cut with tetrahedra "
                    "(.mesh, .msh, .vtk, "
                    ".vtu). Leave it out, or use softreel tetrahedralize.",
                    options.picture.cut, options.mesh));
}

}  // namespace

int run_inspect(const InspectOptions& options) {
  keep_nothing_when_interrupted();
  Console console(Verbosity::Normal, isatty(STDERR_FILENO) != 0);
  if (is_tet_mesh_file(options.mesh)) return inspect_tets(options, console.log());
  check_surface_options(options);
  const SurfaceMesh mesh = import_mesh(options.mesh, console.log());
  const MeshFacts facts = check_mesh(mesh);
  SurfaceMesh repaired = mesh;
  const std::vector<std::string> repairs = repair_mesh(repaired);
  if (options.json)
    std::printf("%s\n", facts_json(options, facts, mesh, repairs).c_str());
  else
    print_facts_text(options, facts, mesh, repairs);
  if (!options.picture.path.empty())
    print_shown(options, draw_surface_picture(mesh, repaired, options.picture, Threads(options.threads)));
  return 0;
}

}  // namespace softreel
