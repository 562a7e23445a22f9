#include "core/tetmesh/stuffing/isosurface_stuffing.h"

#include <bit>
#include <cmath>

#include "core/base/check.h"
#include "core/tetmesh/stuffing/cut_stencils.h"

namespace softreel {
namespace {

constexpr std::int64_t kStuffingGrain = 4096;

/// The lattice nodes while they are warped.
struct WarpedLattice {
  const LatticeDistance& distance;
  std::vector<std::array<Index, kNeighbors>> neighbors;  // -1: not in the set, outside
  std::vector<NodeSign> signs;
  std::vector<Vec3> positions;

  const std::vector<LatticeNode>& nodes() const { return distance.nodes.nodes(); }
};

NodeSign sign_of(double value) {
  return value < 0 ? NodeSign::Inside : value > 0 ? NodeSign::Outside : NodeSign::Surface;
}

bool opposite(NodeSign a, NodeSign b) {
  return static_cast<int>(a) * static_cast<int>(b) < 0;
}

WarpedLattice make_lattice(const LatticeDistance& distance, const Threads& threads) {
  const std::vector<LatticeNode>& nodes = distance.nodes.nodes();
  CHECK(distance.values.size() == nodes.size());
  WarpedLattice lattice{distance, {}, {}, {}};
  lattice.neighbors.resize(nodes.size());
  lattice.signs.resize(nodes.size());
  lattice.positions.resize(nodes.size());
  threads.for_chunks(static_cast<std::int64_t>(nodes.size()), kStuffingGrain,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                         for (std::size_t k = 0; k < kNeighbors; ++k)
                           lattice.neighbors[i][k] = distance.nodes.find(lattice_neighbor(nodes[i], k));
                         lattice.signs[i] = sign_of(distance.values[i]);
                         lattice.positions[i] = lattice_position(distance.frame, nodes[i]);
                       }
                     });
  return lattice;
}

/// Where the surface cuts the edge from node i to node j of opposite sign, as a fraction of the edge.
double cut_fraction(const LatticeDistance& distance, std::size_t i, std::size_t j) {
  const double a = std::abs(distance.values[i]), b = std::abs(distance.values[j]);
  return a / (a + b);
}

/// Moves a node to its nearest violating cut, if it has one.
void warp_node(WarpedLattice& lattice, std::size_t i) {
  if (lattice.signs[i] == NodeSign::Surface) return;
  double nearest = 1e300, nearest_fraction = 0;
  std::size_t target = i;
  for (std::size_t k = 0; k < kNeighbors; ++k) {
    if (lattice.neighbors[i][k] < 0) continue;
    const auto j = static_cast<std::size_t>(lattice.neighbors[i][k]);
    if (!opposite(lattice.signs[i], lattice.signs[j])) continue;
    const bool is_long = k < kLongNeighbors;
    const double fraction = cut_fraction(lattice.distance, i, j);
    const double length = fraction * (is_long ? 2.0 : std::sqrt(3.0));
    if (fraction >= (is_long ? kWarpLong : kWarpShort) || length >= nearest) continue;
    nearest = length;
    nearest_fraction = fraction;
    target = j;
  }
  if (target == i) return;
  lattice.positions[i] += nearest_fraction * (lattice.positions[target] - lattice.positions[i]);
  lattice.signs[i] = NodeSign::Surface;
}

/// Warps one colour after the other: nodes of a colour are no neighbours, so each sees its neighbours' final signs of
/// the colours before, whatever the number of threads.
void warp_nodes(WarpedLattice& lattice, const Threads& threads) {
  for (int color = 0; color < 4; ++color)
    threads.for_chunks(static_cast<std::int64_t>(lattice.nodes().size()), kStuffingGrain,
                       [&](std::int64_t begin, std::int64_t end) {
                         for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
                           if (lattice_color(lattice.nodes()[i]) == color) warp_node(lattice, i);
                       });
}

/// Mesh nodes in the order of the lattice nodes: each inside or surface node, then the cuts of its edges if it is
/// inside.
struct NodeNumbers {
  std::vector<Index> first;         // per lattice node
  std::vector<std::uint16_t> cuts;  // per lattice node: bit k if the edge in direction k is cut
  Index total = 0;

  Index node(std::size_t i) const { return first[i]; }
  Index cut(std::size_t i, std::size_t k) const {
    const auto before = static_cast<unsigned>(cuts[i]) & ((1U << k) - 1U);
    return first[i] + 1 + std::popcount(before);
  }
};

NodeNumbers number_mesh_nodes(const WarpedLattice& lattice) {
  NodeNumbers numbers;
  numbers.first.resize(lattice.signs.size());
  numbers.cuts.resize(lattice.signs.size());
  for (std::size_t i = 0; i < lattice.signs.size(); ++i) {
    numbers.first[i] = numbers.total;
    if (lattice.signs[i] == NodeSign::Outside) continue;
    unsigned cuts = 0;
    for (std::size_t k = 0; k < kNeighbors && lattice.signs[i] == NodeSign::Inside; ++k) {
      const Index j = lattice.neighbors[i][k];
      CHECK(j >= 0);
      if (lattice.signs[static_cast<std::size_t>(j)] == NodeSign::Outside) cuts |= 1U << k;
    }
    numbers.cuts[i] = static_cast<std::uint16_t>(cuts);
    numbers.total += 1 + std::popcount(cuts);
  }
  return numbers;
}

/// A lattice tetrahedron in the stencils' order (even ends first), and whether that order is a mirror image.
struct LatticeCorners {
  std::array<std::size_t, 4> nodes;
  bool mirrored;
};

bool is_even(const LatticeNode& node) {
  return (((node[0] >> 1) + (node[1] >> 1) + (node[2] >> 1)) & 1) == 0;
}

void emit_tets(const WarpedLattice& lattice, const NodeNumbers& numbers, const LatticeCorners& corners,
               std::vector<Tet>& tets) {
  std::array<NodeSign, 4> signs;
  for (std::size_t v = 0; v < 4; ++v) signs[v] = lattice.signs[corners.nodes[v]];
  const CutStencil& stencil = cut_stencil(signs);
  const auto mesh_node = [&](std::uint8_t v) {
    if (v < 4) return numbers.node(corners.nodes[v]);
    auto [a, b] = kStencilEdges[v - 4U];
    if (signs[a] != NodeSign::Inside) std::swap(a, b);
    const std::size_t i = corners.nodes[a], j = corners.nodes[b];
    return numbers.cut(i, neighbor_direction(lattice.nodes()[i], lattice.nodes()[j]));
  };
  for (std::size_t t = 0; t < stencil.count; ++t) {
    Tet tet;
    for (std::size_t v = 0; v < 4; ++v) tet[v] = mesh_node(stencil.tets[t][v]);
    if (corners.mirrored) std::swap(tet[2], tet[3]);
    tets.push_back(tet);
  }
}

/// The four tetrahedra around the long edge from even-sublattice node i along axis c.
void emit_edge(const WarpedLattice& lattice, const NodeNumbers& numbers, std::size_t i, std::size_t c,
               std::vector<Tet>& tets) {
  const Index j = lattice.neighbors[i][2 * c + 1];
  if (j < 0) return;
  const std::size_t a = (c + 1) % 3, b = (c + 2) % 3;
  // Corners of the square around the edge, counter-clockwise seen from +c.
  const std::array<std::size_t, 4> square{0, std::size_t{1} << a, (std::size_t{1} << a) | (std::size_t{1} << b),
                                          std::size_t{1} << b};
  for (std::size_t s = 0; s < 4; ++s) {
    const auto corner = [&](std::size_t at) {
      return lattice.neighbors[i][kLongNeighbors + (square[at] | (std::size_t{1} << c))];
    };
    const Index m = corner(s), n = corner((s + 1) % 4);
    if (m < 0 || n < 0) continue;
    LatticeCorners corners{{i, static_cast<std::size_t>(j), static_cast<std::size_t>(m), static_cast<std::size_t>(n)},
                           false};
    for (const std::size_t v : {0U, 2U}) {
      if (is_even(lattice.nodes()[corners.nodes[v]])) continue;
      std::swap(corners.nodes[v], corners.nodes[v + 1]);
      corners.mirrored = !corners.mirrored;
    }
    emit_tets(lattice, numbers, corners, tets);
  }
}

/// All elements, in chunks of the lattice's order that are joined in that order.
std::vector<Tet> fill_tets(const WarpedLattice& lattice, const NodeNumbers& numbers, const Threads& threads) {
  const std::vector<LatticeNode>& nodes = lattice.nodes();
  const auto n = static_cast<std::int64_t>(nodes.size());
  std::vector<std::vector<Tet>> chunks(static_cast<std::size_t>((n + kStuffingGrain - 1) / kStuffingGrain));
  threads.for_chunks(n, kStuffingGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<Tet>& tets = chunks[static_cast<std::size_t>(begin / kStuffingGrain)];
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      for (std::size_t c = 0; c < 3 && (nodes[i][0] & 1) == 0; ++c) emit_edge(lattice, numbers, i, c, tets);
  });
  std::size_t count = 0;
  for (const auto& chunk : chunks) count += chunk.size();
  std::vector<Tet> tets;
  tets.reserve(count);
  for (auto& chunk : chunks) {
    tets.insert(tets.end(), chunk.begin(), chunk.end());
    std::vector<Tet>().swap(chunk);
  }
  return tets;
}

/// Positions and origins of the numbered nodes.
void place_nodes(const WarpedLattice& lattice, const NodeNumbers& numbers, StuffedMesh& stuffed) {
  const auto total = static_cast<std::size_t>(numbers.total);
  stuffed.mesh.nodes.resize(total);
  stuffed.lattice_nodes.resize(total);
  stuffed.on_surface.resize(total);
  for (std::size_t i = 0; i < lattice.signs.size(); ++i) {
    if (lattice.signs[i] == NodeSign::Outside) continue;
    const auto place = [&](Index node, const Vec3& position, bool on_surface) {
      stuffed.mesh.nodes[static_cast<std::size_t>(node)] = position;
      stuffed.lattice_nodes[static_cast<std::size_t>(node)] = static_cast<Index>(i);
      stuffed.on_surface[static_cast<std::size_t>(node)] = on_surface ? 1 : 0;
    };
    const Vec3& from = lattice.positions[i];
    place(numbers.node(i), from, lattice.signs[i] == NodeSign::Surface);
    for (std::size_t k = 0; k < kNeighbors; ++k) {
      if (((numbers.cuts[i] >> k) & 1) == 0) continue;
      const auto j = static_cast<std::size_t>(lattice.neighbors[i][k]);
      const double fraction = cut_fraction(lattice.distance, i, j);
      place(numbers.cut(i, k), from + fraction * (lattice.positions[j] - from), true);
    }
  }
}

/// Drops nodes that no element uses: surface nodes without an inside neighbour in any of their tetrahedra.
void drop_unused_nodes(StuffedMesh& stuffed) {
  std::vector<Index> number(stuffed.mesh.nodes.size(), -1);
  for (const Tet& tet : stuffed.mesh.tets)
    for (const Index node : tet) number[static_cast<std::size_t>(node)] = 0;
  std::size_t used = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    stuffed.mesh.nodes[used] = stuffed.mesh.nodes[i];
    stuffed.lattice_nodes[used] = stuffed.lattice_nodes[i];
    stuffed.on_surface[used] = stuffed.on_surface[i];
    number[i] = static_cast<Index>(used++);
  }
  stuffed.mesh.nodes.resize(used);
  stuffed.lattice_nodes.resize(used);
  stuffed.on_surface.resize(used);
  for (Tet& tet : stuffed.mesh.tets)
    for (Index& node : tet) node = number[static_cast<std::size_t>(node)];
}

}  // namespace

StuffedMesh stuff_isosurface(const LatticeDistance& distance, const Threads& threads) {
  WarpedLattice lattice = make_lattice(distance, threads);
  warp_nodes(lattice, threads);
  const NodeNumbers numbers = number_mesh_nodes(lattice);
  StuffedMesh stuffed;
  stuffed.mesh.lattice = distance.frame;
  stuffed.mesh.tets = fill_tets(lattice, numbers, threads);
  place_nodes(lattice, numbers, stuffed);
  drop_unused_nodes(stuffed);
  return stuffed;
}

LatticeDistance sample_distance(const LatticeFrame& frame, const Bounds& box,
                                const std::function<double(const Vec3&)>& signed_distance) {
  LatticeDistance distance{frame, {}, {}};
  // Two layers beyond the box: neighbours of inside nodes reach one spacing out.
  LatticeNode low, high;
  for (int k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    low[at] = static_cast<std::int32_t>(std::floor((box.min[k] - frame.origin[k]) * 2.0 / frame.spacing)) - 3;
    high[at] = static_cast<std::int32_t>(std::ceil((box.max[k] - frame.origin[k]) * 2.0 / frame.spacing)) + 3;
  }
  for (std::int32_t z = low[2]; z <= high[2]; ++z)
    for (std::int32_t y = low[1] + ((low[1] ^ z) & 1); y <= high[1]; y += 2)
      for (std::int32_t x = low[0] + ((low[0] ^ z) & 1); x <= high[0]; x += 2) distance.nodes.insert({x, y, z});
  distance.nodes.number_nodes();
  for (const LatticeNode& node : distance.nodes.nodes())
    distance.values.push_back(signed_distance(lattice_position(frame, node)));
  return distance;
}

}  // namespace softreel
