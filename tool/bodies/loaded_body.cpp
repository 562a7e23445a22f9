#include "tool/bodies/loaded_body.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/mesh/mesh_check.h"
#include "core/tetmesh/boundary_surface.h"
#include "core/tetmesh/files/tet_mesh_file.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "tool/bodies/at_field.h"
#include "tool/bodies/weight_maps.h"

namespace softreel {
namespace {

PlacementParams placement_params(const BodySettings& body) {
  PlacementParams params;
  using Up = PlacementParams::Up;
  params.up = body.up == UpAxis::X ? Up::X : body.up == UpAxis::Z ? Up::Z : Up::Y;
  params.fit = body.fit;
  params.scale = body.scale;
  params.translate = body.translate;
  params.rotate_rad = body.rotate_deg * (std::numbers::pi / 180);
  return params;
}

void use_surface(const BodySettings& body, SurfaceUse use, const RunContext& context, LoadedBody& loaded) {
  ReadSurface read = read_surface(body.mesh, use, context);
  loaded.file_mesh = std::move(read.mesh);
  loaded.facts = std::move(read.facts);
  loaded.file_key = std::move(read.key);
  loaded.stored_key = std::move(read.stored);
}

/// Tetrahedra in the mesh field are the body; their boundary is its surface, as sound as they are.
void read_both(const BodySettings& body, const RunContext& context, LoadedBody& loaded) {
  if (!body.tetrahedra.empty())
    throw input_error(fmt::format(
        "{} holds tetrahedra, but tetrahedra = \"{}\" names others.\n  Accepted: a surface as mesh beside tetrahedra, "
        "or tetrahedra as mesh. Leave one of the two out.",
        body.mesh, body.tetrahedra));
  loaded.given = read_tet_mesh(body.mesh, context.log);
  loaded.file_mesh = boundary_surface(*loaded.given);
  loaded.facts = describe(check_mesh(loaded.file_mesh));
  loaded.file_key = mesh_file_key(loaded.file_mesh);
}

void add_tet_facts(const TetMesh& mesh, const Threads& threads, std::vector<std::string>& facts) {
  const TetQuality quality = measure_quality(mesh, threads);
  facts.push_back(fmt::format("{} given tetrahedra, {} nodes, dihedral angles {:.2f} to {:.2f} degrees",
                              mesh.tets.size(), mesh.nodes.size(), quality.min_dihedral, quality.max_dihedral));
}

/// Says which fields of the body's tetrahedra have no effect, as they are given.
void say_ignored(const BodySettings& body, const Log& log) {
  const std::string file = body.tetrahedra.empty() ? body.mesh : body.tetrahedra;
  const auto say = [&](bool is_set, const char* field) {
    if (is_set)
      log.warn(fmt::format("{}: body.{}.{} has no effect: {} gives the tetrahedra.", to_string(body.origin), body.name,
                           field, file));
  };
  say(body.tets > 0, "tets");
  say(body.edge > 0, "edge");
  say(body.error.value > 0, "error");
  say(body.graded, "graded");
  say(body.mode != TetMode::Conforming, "mode");
  say(body.thickness > 0, "thickness");
}

StageKey given_key(const TetMesh& mesh) {
  return KeyHasher("given tetrahedra 2").add(mesh.nodes).add(mesh.tets).add(mesh.fill).key();
}

}  // namespace

LoadedBody load_body(const BodySettings& body, const RunContext& context, std::span<const GlueSettings> glues,
                     SurfaceUse use) {
  const ScopedStage stage(context.times, "load");
  const std::string field = fmt::format("body.{}.mesh", body.name);
  LoadedBody loaded;
  at_field(body.mesh_origin, field, [&] {
    is_tet_mesh_file(body.mesh) ? read_both(body, context, loaded) : use_surface(body, use, context, loaded);
    loaded.placement = place(loaded.file_mesh, placement_params(body));
  });
  if (!body.tetrahedra.empty())
    loaded.given = at_field(body.origin, fmt::format("body.{}.tetrahedra", body.name),
                            [&] { return read_tet_mesh(body.tetrahedra, context.log); });
  loaded.weight_maps = read_weight_maps(body, glues, loaded.file_mesh);
  loaded.surface = loaded.file_mesh;
  apply(loaded.placement, loaded.surface);
  loaded.key = KeyHasher("surface 1").add(loaded.surface.positions).add(loaded.surface.triangles).key();
  if (!loaded.given) return loaded;
  say_ignored(body, context.log);
  add_tet_facts(*loaded.given, context.threads, loaded.facts);
  loaded.given_key = given_key(*loaded.given);
  for (Vec3& node : loaded.given->nodes) node = loaded.placement(node);
  return loaded;
}

}  // namespace softreel
