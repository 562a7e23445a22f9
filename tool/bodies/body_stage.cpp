#include "tool/bodies/body_stage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "core/tetmesh/improvement/angle_improvement.h"
#include "core/tetmesh/triangle_tree.h"
#include "tool/bodies/at_field.h"
#include "tool/cache/bytes.h"
#include "tool/cache/stage_names.h"

namespace softreel {
namespace {

/// Raised whenever the same surface would give other tetrahedra or another embedding.
constexpr const char* kFillVersion = "tetrahedra 13";

std::vector<std::uint8_t> pack(const FilledBody& filled) {
  ByteWriter out;
  out.put(filled.mesh.lattice.spacing);
  for (int k = 0; k < 3; ++k) out.put(filled.mesh.lattice.origin[k]);
  out.put_array(filled.mesh.nodes);
  out.put_array(filled.mesh.tets);
  out.put_array(filled.mesh.fill);
  out.put_array(filled.embedding.elements);
  out.put_array(filled.embedding.weights);
  return out.take();
}

void unpack(std::span<const std::uint8_t> bytes, FilledBody& filled) {
  ByteReader in(bytes);
  filled.mesh.lattice.spacing = in.get<double>();
  for (int k = 0; k < 3; ++k) filled.mesh.lattice.origin[k] = in.get<double>();
  filled.mesh.nodes = in.get_array<Vec3>();
  filled.mesh.tets = in.get_array<Tet>();
  filled.mesh.fill = in.get_array<double>();
  filled.embedding.elements = in.get_array<Index>();
  filled.embedding.weights = in.get_array<std::array<double, 4>>();
}

const MaterialSettings& find_material(const Shot& shot, const std::string& name) {
  const auto found = shot.materials.find(name);
  CHECK(found != shot.materials.end());  // the shot was checked when it was read
  return found->second;
}

std::vector<Vec3> element_centroids(const TetMesh& mesh) {
  std::vector<Vec3> centroids;
  centroids.reserve(mesh.tets.size());
  for (const Tet& tet : mesh.tets) {
    Vec3 sum = Vec3::Zero();
    for (const Index node : tet) sum += mesh.nodes[static_cast<std::size_t>(node)];
    centroids.push_back(0.25 * sum);
  }
  return centroids;
}

}  // namespace

namespace {

/// The wanted distance to the surface, m; 0: none.
double budget_of(const BodySettings& body, const LoadedBody& loaded) {
  return body.error.in_meters(used_bounds(loaded.surface).diagonal());
}

/// Given tetrahedra, with better angles if asked; their boundary stays.
TetMesh optimized(TetMesh mesh, const BodySettings& body, const RunContext& context) {
  if (!body.optimize) return mesh;
  const ScopedStage stage(context.times, "tetrahedralize/optimize");
  const AngleImprovement done = improve_angles(mesh, nullptr, {}, context.threads);
  context.log.info(fmt::format("body '{}': {}", body.name, describe(done)));
  return mesh;
}

TetMesh make_tets(const BodySettings& body, const LoadedBody& loaded, const RunContext& context) {
  if (loaded.given) return optimized(*loaded.given, body, context);
  const TetrahedralizeParams params{.edge = body.edge,
                                    .tets = body.tets,
                                    .error = budget_of(body, loaded),
                                    .graded = body.graded,
                                    .thickness = body.thickness,
                                    .mode = body.mode,
                                    .optimize = body.optimize};
  return tetrahedralize(loaded.surface, params, body.name, context.threads, context.log, context.times);
}

/// Given tetrahedra of another body, or in another unit, would carry the surface anywhere.
void require_match(const BodySettings& body, const LoadedBody& loaded, const FilledBody& filled) {
  constexpr double kFarthest = 0.02;  // of the box's diagonal
  const double limit = kFarthest * used_bounds(loaded.surface).diagonal();
  const TriangleTree tree(filled.mesh.nodes, boundary_faces(filled.mesh));
  const std::vector<bool> used = used_vertices(loaded.surface);
  for (std::size_t v = 0; v < loaded.surface.positions.size(); ++v) {
    if (!used[v]) continue;
    const std::array<double, 4>& weights = filled.embedding.weights[v];
    if (*std::min_element(weights.begin(), weights.end()) >= 0) continue;
    const Vec3& p = loaded.surface.positions[v];
    const double distance = (tree.nearest(p).point - p).norm();
    if (distance <= limit) continue;
    throw input_error(fmt::format(
        "{}: body.{}.tetrahedra: {} does not fit {}: vertex {} is {:.3g} m outside of the tetrahedra.\n  Accepted: "
        "tetrahedra in the place and unit of the surface, {:.3g} m from it at most. Export both from one scene.",
        to_string(body.origin), body.name, body.tetrahedra, body.mesh, v, distance, limit));
  }
}

}  // namespace

StageKey filled_key(const BodySettings& body, const LoadedBody& loaded) {
  KeyHasher key(kFillVersion);
  key.add(loaded.key);
  if (!loaded.surface.joined.empty()) key.add("joined normals");  // points outside are embedded along their normals
  if (loaded.given)
    return key.add(loaded.given->nodes).add(loaded.given->tets).add(loaded.given->fill).add(body.optimize).key();
  return key.add(body.edge)
      .add(body.tets)
      .add(budget_of(body, loaded))
      .add(body.thickness)
      .add(body.graded)
      .add(body.mode)
      .add(body.optimize)
      .key();
}

namespace {

void find_normals(const BodySettings& body, const LoadedBody& loaded, FilledBody& filled) {
  filled.normals = vertex_normals(loaded.surface, loaded.surface.positions);
  if (body.has_creases()) filled.creases = corner_normals(loaded.surface, body.crease_deg * std::numbers::pi / 180);
}

}  // namespace

FilledBody fill_body_anew(const BodySettings& body, const LoadedBody& loaded, const RunContext& context) {
  FilledBody filled;
  find_normals(body, loaded, filled);
  filled.mesh = make_tets(body, loaded, context);
  const ScopedStage stage(context.times, "tetrahedralize/embed");
  filled.embedding = embed_points(loaded.surface.positions, filled.normals, filled.mesh, context.threads);
  if (!body.tetrahedra.empty()) require_match(body, loaded, filled);
  return filled;
}

FilledBody fill_body(const BodySettings& body, const LoadedBody& loaded, const StageKey& key,
                     const RunContext& context) {
  FilledBody filled;
  const auto fill = [&] {
    filled = fill_body_anew(body, loaded, context);
    return pack(filled);
  };
  const Cache::Produced produced = context.cache.produce(
      kTetrahedraStage, key, [&] { context.stop_if_cancelled(); }, fill);
  filled.from_cache = produced.from_cache;
  filled.seconds = produced.seconds;
  if (produced.from_cache) {
    find_normals(body, loaded, filled);
    unpack(produced.bytes, filled);
  }
  return filled;
}

namespace {

std::string region_field(const BodySettings& body, std::size_t index) {
  return fmt::format("body.{}.region[{}]", body.name, index);
}

void add(KeyHasher& key, const ElementMaterial& m) {
  key.add(m.youngs_modulus).add(m.poisson_ratio).add(m.density).add(m.damping_mass).add(m.damping_stiffness);
}

/// The numbers of a selection; what it takes by name or by nearness is covered by the points it takes.
void add(KeyHasher& key, const SelectionTerm& term) {
  key.add(term.unit).add(term.shape.index());
  if (const auto* box = std::get_if<SelectBox>(&term.shape)) key.add(box->min).add(box->max);
  if (const auto* sphere = std::get_if<SelectSphere>(&term.shape)) key.add(sphere->center).add(sphere->radius);
  if (const auto* plane = std::get_if<SelectPlane>(&term.shape)) key.add(plane->point).add(plane->normal);
}

}  // namespace

void add_materials(KeyHasher& key, const Shot& shot, const BodySettings& body, const LoadedBody& loaded) {
  add(key, find_material(shot, body.material).physics);
  for (std::size_t i = 0; i < body.regions.size(); ++i) {
    const RegionSettings& region = body.regions[i];
    for (const SelectionTerm& term : region.select.terms) {
      add(key, term);
      key.add(at_field(region.origin, region_field(body, i) + ".select",
                       [&] { return select_points({{term}}, loaded.surface, loaded.weight_maps); }));
    }
    key.add(region.material.has_value()).add(region.stiffness.value_or(0.0));
    if (region.material) add(key, find_material(shot, *region.material).physics);
  }
}

std::vector<ElementMaterial> element_materials(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                                               const TetMesh& mesh) {
  const ElementMaterial base = find_material(shot, body.material).physics;
  std::vector<ElementMaterial> materials(mesh.tets.size(), base);
  const std::vector<Vec3> centroids = element_centroids(mesh);
  for (const RegionSettings& region : body.regions) {
    const std::vector<bool> inside = contains(region.select, loaded.surface, centroids, loaded.weight_maps);
    for (std::size_t e = 0; e < inside.size(); ++e) {
      if (!inside[e]) continue;
      if (region.material) materials[e] = find_material(shot, *region.material).physics;
      if (region.stiffness) materials[e].youngs_modulus = base.youngs_modulus * *region.stiffness;
    }
  }
  return materials;
}

void require_regions(const BodySettings& body, const LoadedBody& loaded, const TetMesh& mesh) {
  const std::vector<Vec3> centroids = element_centroids(mesh);
  for (std::size_t i = 0; i < body.regions.size(); ++i) {
    const RegionSettings& region = body.regions[i];
    const std::vector<bool> inside = contains(region.select, loaded.surface, centroids, loaded.weight_maps);
    if (std::find(inside.begin(), inside.end(), true) != inside.end()) continue;
    const Bounds box = used_bounds(loaded.surface);
    throw input_error(fmt::format(
        "{}: {}.select takes no tetrahedron.\n  The body reaches from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, "
        "{:.4g}) m. Accepted: a selection that takes the centre of at least one; enlarge it, use unit = \"box\", or "
        "take more tetrahedra.",
        to_string(region.origin), region_field(body, i), box.min.x(), box.min.y(), box.min.z(), box.max.x(),
        box.max.y(), box.max.z()));
  }
}

BodyModel make_body_model(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                          const FilledBody& filled, const BodyConstraints& constraints) {
  BodyModel model;
  model.name = body.name;
  model.mesh = filled.mesh;
  model.surface_points = loaded.surface.positions;
  model.embedding = filled.embedding;
  model.gravity = shot.gravity;
  model.materials = element_materials(shot, body, loaded, filled.mesh);
  model.pins = constraints.pins;
  model.pulls = constraints.pulls;
  return model;
}

}  // namespace softreel
