#include "tool/export/vdb_export.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/mesh/mesh_check.h"
#include "core/mesh/mesh_topology.h"
#include "core/mesh/winding_number.h"
#include "tool/export/level_set.h"

namespace softreel {
namespace {

/// Throws input_error unless the surface has an inside. What OpenVDB's flood makes of a surface with holes depends on
/// the voxels: with a hole larger than one it leaks, and there is no inside.
void require_closed(const ExportBody& body) {
  const MeshFacts facts = check_mesh(*body.mesh);
  if (facts.boundary_edges == 0) return;
  throw input_error(fmt::format(
      "--format vdb: the surface of body {} is not closed: {} holes with {} edges. A level set needs an inside.\n"
      "  Accepted: closed surfaces. Close the holes in the mesh file, or export vtu, which has the tetrahedra.",
      body.name, facts.holes, facts.boundary_edges));
}

/// True if a shell of the surface points inwards, as the wall of a cavity does once the mesh was repaired.
bool has_cavity(const SurfaceMesh& mesh) {
  const std::vector<Triangle> welded = welded_triangles(mesh);
  DisjointSets shells(mesh.positions.size());
  for (const Triangle& t : welded) {
    shells.join(t[0], t[1]);
    shells.join(t[0], t[2]);
  }
  std::map<Index, double> volumes;
  const Vec3 center = used_bounds(mesh).center();
  const auto at = [&](Index v) -> Vec3 { return mesh.positions[static_cast<std::size_t>(v)] - center; };
  for (const Triangle& t : welded) volumes[shells.root(t[0])] += signed_volume6(at(t[0]), at(t[1]), at(t[2]));
  return std::any_of(volumes.begin(), volumes.end(), [](const auto& shell) { return shell.second < 0; });
}

class VdbWriter : public ExportWriter {
 public:
  explicit VdbWriter(ExportTarget target) : target_(std::move(target)) {
    require_level_sets();
    require_closed(target_.bodies[0]);
  }

  void append(const ExportSample& sample) override {
    CHECK(sample.tets != nullptr);
    const ExportBody& body = target_.bodies[sample.body];
    LevelSetSurface surface{sample.positions, body.mesh->triangles};
    std::optional<WindingNumber> winding;
    if (has_cavity(*body.mesh)) {
      winding.emplace(std::vector<Vec3>(sample.positions.begin(), sample.positions.end()), body.mesh->triangles);
      surface.is_inside = [&winding](const Vec3& point) { return (*winding)(point) > 0.5; };
    }
    LevelSetParams params;
    params.voxel = target_.settings.voxel > 0 ? target_.settings.voxel : own_voxel(body, *sample.tets);
    const double voxels = estimate_voxels(surface, params);
    if (!(voxels < kMostVoxels))
      throw input_error(
          fmt::format("--voxel: {:.4g} makes about {:.2g} voxels near the surface of body {} at frame {}.\n"
                      "  Accepted: up to {:.2g}, here a voxel of {:.4g}.",
                      params.voxel, voxels, body.name, sample.frame, kMostVoxels,
                      1.01 * params.voxel * std::sqrt(voxels / kMostVoxels)));
    target_.sink(encode_level_set(surface, params, *target_.threads));
  }
  void finish() override {}

 private:
  /// The same at all samples: of the body at rest.
  static double own_voxel(const ExportBody& body, const TetSample& tets) {
    Bounds bounds;
    for (const Vec3& node : tets.filled.mesh.nodes) bounds.add(body.scene_to_space(node));
    return bounds.diagonal() / kVoxelsAcross;
  }

  ExportTarget target_;
};

}  // namespace

ExportFormat vdb_format() {
  ExportFormat format;
  format.name = "vdb";
  format.about = "OpenVDB level set of the surface, a file a sample; see --voxel";
  format.file_per = FilePer::Sample;
  format.needs_tets = true;
  format.has_voxel = true;
  format.make = [](ExportTarget target) { return std::make_unique<VdbWriter>(std::move(target)); };
  return format;
}

}  // namespace softreel
