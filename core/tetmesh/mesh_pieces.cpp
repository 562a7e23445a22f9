#include "core/tetmesh/mesh_pieces.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/mesh/disjoint_sets.h"

namespace softreel {
namespace {

/// Pieces of a mesh with a manifold boundary, where elements that share a node are joined through faces too.
struct Pieces {
  std::vector<Index> tet_pieces;  // per element
  std::vector<double> volumes;    // per piece, m^3
  std::vector<Index> sizes;       // per piece, elements
};

Pieces find_pieces(const TetMesh& mesh) {
  DisjointSets sets(mesh.nodes.size());
  for (const Tet& tet : mesh.tets)
    for (std::size_t k = 1; k < 4; ++k) sets.join(tet[0], tet[k]);
  Pieces pieces;
  pieces.tet_pieces.reserve(mesh.tets.size());
  std::vector<Index> number(mesh.nodes.size(), -1);
  for (const auto& [a, b, c, d] : mesh.tets) {
    Index& piece = number[at(sets.root(a))];
    if (piece < 0) {
      piece = static_cast<Index>(pieces.volumes.size());
      pieces.volumes.push_back(0);
      pieces.sizes.push_back(0);
    }
    pieces.tet_pieces.push_back(piece);
    pieces.volumes[at(piece)] += tet_volume(mesh.nodes[at(a)], mesh.nodes[at(b)], mesh.nodes[at(c)], mesh.nodes[at(d)]);
    ++pieces.sizes[at(piece)];
  }
  return pieces;
}

/// The part of the surface near a mesh node, -1 deep inside.
Index part_near(const StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles, const SurfaceParts& parts,
                Index node) {
  const Index triangle = nearest_triangles[at(stuffed.lattice_nodes[at(node)])];
  return triangle < 0 ? -1 : parts.triangle_parts[at(triangle)];
}

/// The largest piece that each part of the surface bounds, -1 if none.
std::vector<Index> main_pieces(const StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles,
                               const SurfaceParts& parts, const Pieces& pieces) {
  std::vector<Index> main(parts.parts.size(), -1);
  for (std::size_t e = 0; e < stuffed.mesh.tets.size(); ++e) {
    const Index piece = pieces.tet_pieces[e];
    for (const Index node : stuffed.mesh.tets[e]) {
      const Index part = part_near(stuffed, nearest_triangles, parts, node);
      if (part < 0 || main[at(part)] == piece) continue;
      Index& best = main[at(part)];
      if (best < 0 || pieces.volumes[at(piece)] > pieces.volumes[at(best)]) best = piece;
    }
  }
  return main;
}

void remove_pieces(StuffedMesh& stuffed, const Pieces& pieces, const std::vector<bool>& removed) {
  std::size_t kept = 0;
  for (std::size_t e = 0; e < stuffed.mesh.tets.size(); ++e)
    if (!removed[at(pieces.tet_pieces[e])]) stuffed.mesh.tets[kept++] = stuffed.mesh.tets[e];
  stuffed.mesh.tets.resize(kept);
}

/// An edge length with which a part that vanished should appear: 2 V / A is the thickness of a plate, the radius of a
/// rod and two thirds of that of a ball, and each then holds lattice nodes. A cavity may leave less of it: then half of
/// the edge that was too long.
double needed_edge(const SurfacePart& part, double edge) {
  return std::min(2.0 * std::abs(part.volume) / part.area, 0.5 * edge);
}

}  // namespace

void drop_crumbs(StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles, const SurfaceParts& parts,
                 const std::string& name, const Log& log) {
  const Pieces pieces = find_pieces(stuffed.mesh);
  if (pieces.volumes.size() <= 1) return;
  std::vector<bool> is_main(pieces.volumes.size(), false), removed(pieces.volumes.size(), false);
  for (const Index piece : main_pieces(stuffed, nearest_triangles, parts, pieces))
    if (piece >= 0) is_main[at(piece)] = true;
  const double cell = std::pow(stuffed.mesh.lattice.spacing, 3);
  Index crumbs = 0, crumb_tets = 0, loose = 0;
  for (std::size_t p = 0; p < is_main.size(); ++p) {
    if (is_main[p]) continue;
    if (pieces.volumes[p] < cell) {
      removed[p] = true;
      ++crumbs;
      crumb_tets += pieces.sizes[p];
    } else {
      ++loose;
    }
  }
  if (crumbs > 0) {
    remove_pieces(stuffed, pieces, removed);
    log.info(fmt::format("body '{}': removed {} loose crumb{} ({} tetrahedra, each crumb smaller than a lattice cell)",
                         name, crumbs, crumbs == 1 ? "" : "s", crumb_tets));
  }
  if (loose > 0)
    log.warn(
        fmt::format("body '{}': parts thinner than the lattice (edge {:.4g} m) fell apart: {} loose piece{} beside "
                    "the main ones. Use a smaller edge or more tets if they should hang together.",
                    name, stuffed.mesh.lattice.spacing, loose, loose == 1 ? "" : "s"));
}

void require_all_parts(const StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles,
                       const SurfaceParts& parts, const std::string& name, const Log& log) {
  std::vector<bool> present(parts.parts.size(), false);
  for (const Tet& tet : stuffed.mesh.tets)
    for (const Index node : tet) {
      const Index part = part_near(stuffed, nearest_triangles, parts, node);
      if (part >= 0) present[at(part)] = true;
    }
  for (std::size_t p = 0; p < present.size(); ++p) {
    if (present[p]) continue;
    const SurfacePart& part = parts.parts[p];
    const std::string where = part.place();
    if (part.is_flat()) {
      log.warn(fmt::format("body '{}': {} encloses no volume and has no tetrahedra", name, where));
      continue;
    }
    if (part.open)
      throw input_error(fmt::format(
          "body '{}': {} is open and encloses nothing that an edge of {:.4g} m sees. Accepted: a surface that encloses "
          "a volume, or an open sheet with a thickness. Set thickness, close the surface, or take the part out of it.",
          name, where, stuffed.mesh.lattice.spacing));
    throw input_error(fmt::format(
        "body '{}': {} is too thin for the lattice: an edge of {:.4g} m leaves it without a tetrahedron. Accepted: an "
        "edge of about {:.2g} m or less. Set a smaller edge or more tets, or take the part out of the surface.",
        name, where, stuffed.mesh.lattice.spacing, needed_edge(part, stuffed.mesh.lattice.spacing)));
  }
}

void order_nodes(StuffedMesh& stuffed) {
  std::vector<Index> number(stuffed.mesh.nodes.size(), -1), order;
  order.reserve(stuffed.mesh.nodes.size());
  for (const Tet& tet : stuffed.mesh.tets)
    for (const Index node : tet) number[at(node)] = 0;
  for (std::size_t i = 0; i < number.size(); ++i)
    if (number[i] == 0) order.push_back(static_cast<Index>(i));
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return stuffed.lattice_nodes[at(a)] < stuffed.lattice_nodes[at(b)]; });
  StuffedMesh ordered;
  ordered.mesh.lattice = stuffed.mesh.lattice;
  ordered.mesh.tets.swap(stuffed.mesh.tets);
  ordered.mesh.nodes.reserve(order.size());
  ordered.lattice_nodes.reserve(order.size());
  ordered.on_surface.reserve(order.size());
  for (const Index node : order) {
    number[at(node)] = static_cast<Index>(ordered.mesh.nodes.size());
    ordered.mesh.nodes.push_back(stuffed.mesh.nodes[at(node)]);
    ordered.lattice_nodes.push_back(stuffed.lattice_nodes[at(node)]);
    ordered.on_surface.push_back(stuffed.on_surface[at(node)]);
  }
  for (Tet& tet : ordered.mesh.tets)
    for (Index& node : tet) node = number[at(node)];
  stuffed = std::move(ordered);
}

}  // namespace softreel
