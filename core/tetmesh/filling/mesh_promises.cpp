#include "core/tetmesh/filling/mesh_promises.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/mesh/disjoint_sets.h"
#include "core/mesh/mesh_topology.h"
#include "core/tetmesh/boundary_check.h"
#include "core/tetmesh/tet_quality.h"

namespace softreel {
namespace {

/// Shells of a surface: triangles that are connected across edges which have two of them. Cubes that share no more than
/// a corner or an edge are two.
Index count_shells(const SurfaceMesh& surface) {
  const std::vector<Triangle> welded = welded_triangles(surface);
  const std::vector<HalfEdge> sides = sorted_half_edges(welded);
  DisjointSets sets(welded.size());
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    if (edge.size() == 2) sets.join(edge[0].triangle, edge[1].triangle);
  });
  Index shells = 0;
  for (std::size_t t = 0; t < welded.size(); ++t)
    shells += !is_collapsed(welded[t]) && sets.root(static_cast<Index>(t)) == static_cast<Index>(t) ? 1 : 0;
  return shells;
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

void require_manifold(const TetMesh& mesh, const std::string& name) {
  const BoundaryDefects defects = check_boundary(mesh.nodes, find_boundary(mesh));
  if (defects.none()) return;
  throw work_error(fmt::format(
      "body '{}': the boundary of its tetrahedra is no manifold at {} edges and {} vertices, the first at ({:.6g}, "
      "{:.6g}, {:.6g}). Accepted: none. Use another edge length, and keep the mesh: this should not happen.",
      name, defects.edges, defects.vertices, defects.first[0], defects.first[1], defects.first[2]));
}

void require_whole(const TetMesh& mesh, const SurfaceMesh& solid, double edge, const std::string& part,
                   const std::string& name) {
  const std::vector<Index> piece_of = face_connected_pieces(mesh);
  const Index pieces = piece_of.empty() ? 0 : *std::max_element(piece_of.begin(), piece_of.end()) + 1;
  if (pieces <= 1 || pieces <= count_shells(solid)) return;
  throw input_error(fmt::format(
      "body '{}': {} is too thin for the lattice: with an edge of {:.4g} m it falls into {} pieces. "
      "Accepted: an edge of about {:.2g} m or less. Set a smaller edge or more tets, or mode = \"embedded\", "
      "which holds together whatever the edge.",
      name, part, edge, pieces, 0.5 * edge));
}

}  // namespace softreel
