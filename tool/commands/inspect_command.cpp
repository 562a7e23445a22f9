#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/mesh/mesh_check.h"
#include "core/mesh/mesh_repair.h"
#include "core/mesh/readers/mesh_import.h"
#include "tool/commands/commands.h"

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
  return json.dump(1);
}

}  // namespace

int run_inspect(const InspectOptions& options) {
  Console console(Verbosity::Normal, isatty(STDERR_FILENO) != 0);
  SurfaceMesh mesh = import_mesh(options.mesh, console.log());
  const MeshFacts facts = check_mesh(mesh);
  const std::vector<std::string> repairs = repair_mesh(mesh);
  if (options.json) {
    std::printf("%s\n", facts_json(options, facts, mesh, repairs).c_str());
    return 0;
  }
  const Vec3 size = facts.bounds.size();
  std::printf("%s: %zu polygons; box %.6g x %.6g x %.6g from (%.6g, %.6g, %.6g)\n", options.mesh.c_str(),
              mesh.polygons.size(), size.x(), size.y(), size.z(), facts.bounds.min.x(), facts.bounds.min.y(),
              facts.bounds.min.z());
  for (const std::string& line : describe(facts)) std::printf("  %s\n", line.c_str());
  for (const std::string& line : repairs) std::printf("  a shot would repair: %s\n", line.c_str());
  for (const VertexGroup& group : mesh.groups)
    std::printf("  group \"%s\": %zu vertices\n", group.name.c_str(), group.vertices.size());
  return 0;
}

}  // namespace softreel
