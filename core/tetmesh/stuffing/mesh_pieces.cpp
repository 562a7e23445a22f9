#include "core/tetmesh/stuffing/mesh_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/mesh/disjoint_sets.h"

namespace softreel {
namespace {

/// Crumbs of more than this share of the volume are not dropped without a warning.
constexpr double kMuchVolume = 0.01;

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

struct Crumbs {
  std::vector<bool> is_crumb;  ///< per piece
  Index count = 0, tets = 0;   ///< of the crumbs
  Index loose = 0;             ///< pieces that are neither main ones nor crumbs
  double share = 0;            ///< of the volume of all pieces
};

Crumbs find_crumbs(const StuffedMesh& stuffed, const std::vector<Index>& main, const Pieces& pieces,
                   const CrumbLimits& limits) {
  const double cell = std::pow(stuffed.mesh.lattice.spacing, 3);
  const double all = std::accumulate(pieces.volumes.begin(), pieces.volumes.end(), 0.0);
  std::vector<bool> is_main(pieces.volumes.size(), false);
  for (const Index piece : main)
    if (piece >= 0) is_main[at(piece)] = true;
  Crumbs crumbs{std::vector<bool>(pieces.volumes.size(), false)};
  for (std::size_t p = 0; p < pieces.volumes.size(); ++p) {
    if (is_main[p]) continue;
    if (pieces.volumes[p] < cell && pieces.sizes[p] < limits.tets) {
      crumbs.is_crumb[p] = true;
      ++crumbs.count;
      crumbs.tets += pieces.sizes[p];
      crumbs.share += pieces.volumes[p] / all;
    } else {
      ++crumbs.loose;
    }
  }
  if (!(crumbs.share > limits.share)) return crumbs;
  return {std::vector<bool>(pieces.volumes.size(), false), 0, 0, crumbs.loose + crumbs.count, 0};
}

void remove_pieces(StuffedMesh& stuffed, const Pieces& pieces, const std::vector<bool>& removed) {
  std::size_t kept = 0;
  for (std::size_t e = 0; e < stuffed.mesh.tets.size(); ++e)
    if (!removed[at(pieces.tet_pieces[e])]) stuffed.mesh.tets[kept++] = stuffed.mesh.tets[e];
  stuffed.mesh.tets.resize(kept);
}

/// Per piece the solid that most of its nodes are near, -1 for none: where solids touch, some are near another.
std::vector<Index> nearest_solids(const StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles,
                                  const std::vector<Index>& tet_pieces, const std::vector<Index>& triangle_solids,
                                  std::size_t count) {
  std::map<std::array<Index, 2>, Index> nodes;  // of piece and solid
  for (std::size_t e = 0; e < tet_pieces.size(); ++e)
    for (const Index node : stuffed.mesh.tets[e]) {
      const Index triangle = nearest_triangles[at(stuffed.lattice_nodes[at(node)])];
      if (triangle >= 0 && triangle_solids[at(triangle)] >= 0) ++nodes[{tet_pieces[e], triangle_solids[at(triangle)]}];
    }
  std::vector<Index> solids(count, -1), most(count, 0);
  for (const auto& [pair, number] : nodes)
    if (number > most[at(pair[0])]) {
      most[at(pair[0])] = number;
      solids[at(pair[0])] = pair[1];
    }
  return solids;
}

/// An edge length with which a part that vanished should appear: 2 V / A is the thickness of a plate, the radius of a
/// rod and two thirds of that of a ball, and each then holds lattice nodes. A cavity may leave less of it: then half of
/// the edge that was too long.
double needed_edge(const SurfacePart& part, double edge) {
  return std::min(2.0 * std::abs(part.volume) / part.area, 0.5 * edge);
}

}  // namespace

Index drop_crumbs(StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles, const SurfaceParts& parts,
                  const CrumbLimits& limits, const std::string& name, const Log& log) {
  const Pieces pieces = find_pieces(stuffed.mesh);
  const auto count = static_cast<Index>(pieces.volumes.size());
  if (count <= 1) return count;
  const Crumbs crumbs = find_crumbs(stuffed, main_pieces(stuffed, nearest_triangles, parts, pieces), pieces, limits);
  if (crumbs.count > 0) {
    remove_pieces(stuffed, pieces, crumbs.is_crumb);
    const std::string line =
        fmt::format("body '{}': removed {} loose crumb{} ({} tetrahedra, each crumb smaller than a lattice cell)", name,
                    crumbs.count, crumbs.count == 1 ? "" : "s", crumbs.tets);
    if (crumbs.share > kMuchVolume)
      log.warn(fmt::format("{}: {:.0f} % of the volume. Use a smaller edge or more tets.", line, 100 * crumbs.share));
    else
      log.info(line);
  }
  if (crumbs.loose > 0)
    log.warn(fmt::format(
        "body '{}': fell apart: {} loose piece{} beside the main ones, as what joins them is thinner than the "
        "lattice (edge {:.4g} m) or they only touch at edges and vertices. Use a smaller edge or more tets if "
        "they should hang together.",
        name, crumbs.loose, crumbs.loose == 1 ? "" : "s", stuffed.mesh.lattice.spacing));
  return count - crumbs.count;
}

std::vector<bool> find_main_pieces(const StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles,
                                   const std::vector<Index>& tet_pieces, const std::vector<Index>& triangle_solids) {
  std::vector<Index> sizes;
  for (const Index piece : tet_pieces) {
    if (at(piece) >= sizes.size()) sizes.resize(at(piece) + 1, 0);
    ++sizes[at(piece)];
  }
  const std::vector<Index> solids =
      triangle_solids.empty() ? std::vector<Index>(sizes.size(), 0)
                              : nearest_solids(stuffed, nearest_triangles, tet_pieces, triangle_solids, sizes.size());
  std::vector<Index> main;  // per solid
  for (std::size_t p = 0; p < sizes.size(); ++p) {
    if (solids[p] < 0) continue;
    if (at(solids[p]) >= main.size()) main.resize(at(solids[p]) + 1, -1);
    Index& best = main[at(solids[p])];
    if (best < 0 || sizes[p] > sizes[at(best)]) best = static_cast<Index>(p);
  }
  std::vector<bool> is_main(sizes.size(), false);
  for (const Index piece : main)
    if (piece >= 0) is_main[at(piece)] = true;
  return is_main;
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
