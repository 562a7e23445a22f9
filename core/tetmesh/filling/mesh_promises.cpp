#include "core/tetmesh/filling/mesh_promises.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/mesh/mesh_topology.h"
#include "core/tetmesh/quality/boundary_check.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "core/tetmesh/quality/tunnels.h"
#include "core/tetmesh/stuffing/boundary_mending.h"

namespace softreel {

Index count_pieces(const TetMesh& mesh) {
  const std::vector<Index> piece_of = face_connected_pieces(mesh);
  return piece_of.empty() ? 0 : *std::max_element(piece_of.begin(), piece_of.end()) + 1;
}

namespace {

double filled_volume(const TetMesh& mesh) {
  double volume = 0;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const auto node = [&](std::size_t k) -> const Vec3& { return mesh.nodes[at(mesh.tets[e][k])]; };
    volume += mesh.fill_of(e) * tet_volume(node(0), node(1), node(2), node(3));
  }
  return volume;
}

/// Volume of the tetrahedra in units of the surface's, where that is known: of one closed part. Else 1.
double share_of_volume(const TetMesh& mesh, const Solid& solid) {
  if (solid.parts.parts.size() != 1 || solid.has_open_parts()) return 1;
  return filled_volume(mesh) / std::abs(solid.parts.parts.front().volume);
}

/// The same of several closed parts, but of all volumes together: what overlaps and cavities count too often, so it is
/// that or more.
double least_share_of_volume(const TetMesh& mesh, const Solid& solid) {
  if (solid.has_open_parts()) return 1;
  double volume = 0;
  for (const SurfacePart& part : solid.parts.parts) volume += std::abs(part.volume);
  return filled_volume(mesh) / volume;
}

/// Whether the tetrahedra miss so much of a surface that a loss of volume may come from there. If not, it overlaps
/// itself: its volume counts twice.
bool is_cut_off(double loss, const TetMesh& mesh, const Solid& solid, const Threads& threads) {
  double area = 0;
  for (const Triangle& t : solid.surface.triangles) {
    const auto x = [&](std::size_t k) -> const Vec3& { return solid.surface.positions[at(t[k])]; };
    area += 0.5 * (x(1) - x(0)).cross(x(2) - x(0)).norm();
  }
  return loss <= area * measure_deviation(solid.surface, mesh, threads).from_surface;
}

}  // namespace

void require_quality(const TetMesh& mesh, const AngleBounds& bounds, const std::string& name, const Threads& threads) {
  const auto nodes = static_cast<Index>(mesh.nodes.size());
  for (const Tet& tet : mesh.tets)
    for (const Index node : tet) {
      CHECK(node >= 0);
      CHECK(node < nodes);
    }
  const TetQuality quality = measure_quality(mesh, threads);
  if (quality.min_volume > 0 && quality.min_dihedral >= bounds.min && quality.max_dihedral <= bounds.max) return;
  throw work_error(fmt::format(
      "body '{}': a tetrahedron is worse than promised: volume {:.3g} m^3 (element {}), dihedral angles {:.4g} to "
      "{:.4g} "
      "degrees (elements {}, {}). Accepted: positive volume, {} to {} degrees. The body may be too far from the origin "
      "for its size; move it nearer, or use another edge length.",
      name, quality.min_volume, quality.min_volume_tet, quality.min_dihedral, quality.max_dihedral,
      quality.min_dihedral_tet, quality.max_dihedral_tet, bounds.min, bounds.max));
}

void say_joined_limbs(const TetMesh& mesh, const std::string& name, const Log& log) {
  const BoundaryDefects defects = check_boundary(mesh.nodes, find_boundary(mesh));
  if (!defects.none())
    log.info(fmt::format(
        "body '{}': limbs side by side in one lattice tetrahedron join: its boundary is no manifold at {} edges "
        "and {} vertices, the first at ({:.6g}, {:.6g}, {:.6g})",
        name, defects.edges, defects.vertices, defects.first[0], defects.first[1], defects.first[2]));
}

void require_manifold(const TetMesh& mesh, const std::string& name) {
  const BoundaryDefects defects = check_boundary(mesh.nodes, find_boundary(mesh));
  if (defects.none()) return;
  throw work_error(fmt::format(
      "body '{}': the boundary of its tetrahedra is no manifold at {} edges and {} vertices, the first at ({:.6g}, "
      "{:.6g}, {:.6g}). Accepted: none. Use another edge length, and keep the mesh: this should not happen.",
      name, defects.edges, defects.vertices, defects.first[0], defects.first[1], defects.first[2]));
}

bool is_whole(const TetMesh& mesh, const SurfaceMesh& surface) {
  const Index pieces = count_pieces(mesh);
  return pieces <= 1 || pieces <= count_solids(surface);
}

void require_whole(const TetMesh& mesh, const SurfaceMesh& solid, double edge, const std::string& part,
                   const std::string& name) {
  if (is_whole(mesh, solid)) return;
  throw input_error(fmt::format(
      "body '{}': {} is too thin for the lattice: with an edge of {:.4g} m it falls into {} pieces. "
      "Accepted: an edge of about {:.2g} m or less. Set a smaller edge or more tets, or mode = \"embedded\", "
      "which holds together whatever the edge.",
      name, part, edge, count_pieces(mesh), 0.5 * edge));
}

Index count_new_tunnels(const StuffedMesh& stuffed, const Solid& solid) {
  if (solid.parts.parts.size() != 1) return 0;
  std::vector<Triangle> faces;
  for (const BoundaryFace& face : find_surface_faces(stuffed)) faces.push_back(face.nodes);
  const Index made = count_manifold_tunnels(faces);
  if (made == 0) return 0;
  const std::optional<Index> given = count_tunnels(welded_triangles(solid.surface));
  return given ? std::max(made - *given, 0) : 0;
}

void warn_of_tunnels(const StuffedMesh& stuffed, const Solid& solid, const std::string& name, const Log& log) {
  const Index tunnels = count_new_tunnels(stuffed, solid);
  if (tunnels == 0) return;
  log.warn(fmt::format(
      "body '{}': the tetrahedra have {} tunnel{} that {} does not have: a wall about as thin as they are was "
      "perforated, or limbs that come near each other, or overlap, grew together. Accepted: this mesh, as it is. A "
      "smaller edge or more tets mend what is thin or near, mode = \"embedded\" covers it.",
      name, tunnels, tunnels == 1 ? "" : "s", solid.parts.parts.front().place()));
}

void warn_of_volume(const TetMesh& mesh, const Solid& solid, const std::string& name, const Threads& threads,
                    const Log& log) {
  constexpr double kMost = 0.05;
  if (solid.parts.parts.size() > 1) {
    const double more = least_share_of_volume(mesh, solid) - 1;
    if (more > kMost)
      log.warn(
          fmt::format("body '{}': the tetrahedra have {:.0f} % or more too much volume, for what the {} parts of "
                      "the surface enclose: what is thinner than they are was thickened. A smaller edge or more "
                      "tets follow it better.",
                      name, 100 * more, solid.parts.parts.size()));
    return;
  }
  const double more = share_of_volume(mesh, solid) - 1;
  if (std::abs(more) <= kMost) return;
  const SurfacePart& part = solid.parts.parts.front();
  if (more < 0 && !is_cut_off(-more * std::abs(part.volume), mesh, solid, threads)) return;
  log.warn(
      fmt::format("body '{}': the tetrahedra have {:.0f} % {} volume than {} encloses: {}. A smaller edge or more "
                  "tets follow it better.",
                  name, 100 * std::abs(more), more > 0 ? "more" : "less", part.place(),
                  more > 0 ? "what is thinner than they are was thickened"
                           : "they cut off what is round or thin, or it overlaps itself"));
}

void require_most_of(const TetMesh& mesh, const Solid& solid, const std::string& name, const Threads& threads) {
  constexpr double kLeast = 0.8, kFarShare = 0.1;
  const double share = share_of_volume(mesh, solid);
  const SurfacePart& part = solid.parts.parts.front();
  // Coarse ones cut off what is convex; a surface that overlaps itself counts its volume twice.
  if (share >= kLeast ||
      measure_deviation(solid.surface, mesh, threads).from_surface <= kFarShare * part.box.diagonal())
    return;
  throw input_error(
      fmt::format("body '{}': {} is too thin for the tetrahedra: they fill {:.0f} % of its volume. Accepted: {} % or "
                  "more. Set a smaller edge or more tets, or mode = \"embedded\", which covers it whatever the edge.",
                  name, part.place(), 100 * share, 100 * kLeast));
}

}  // namespace softreel
