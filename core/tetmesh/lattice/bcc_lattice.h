/// Indexing of the body-centred cubic (BCC) lattice and its tetrahedra.
///
/// Nodes are integer triples in units of half the spacing: all even (corners of cubes) or all odd (their centres). Each
/// tetrahedron joins the centres of two neighbouring cubes (a long edge along axis c) and one edge of the square
/// between them (a long edge along axis b). A lattice of twice the spacing and the same origin is nested in it: the
/// tetrahedra of one are unions of 8 of the other's (Molino, Bridson, Teran, Fedkiw 2003).
#pragma once

#include <array>
#include <cstdint>

#include "core/base/types.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// A lattice node in units of spacing / 2; all coordinates even or all odd.
using LatticeNode = std::array<std::int32_t, 3>;

/// A tetrahedron of the lattice that contains a point, and the point's barycentric weights (sum 1, none below 0 but
/// for round-off). Nodes: two cube centres, then the ends of the square's edge; orientation not fixed.
struct LatticeTet {
  std::array<LatticeNode, 4> nodes;
  std::array<double, 4> weights;
};

/// Position of a lattice node, m.
Vec3 lattice_position(const LatticeFrame& frame, const LatticeNode& node);

/// The tetrahedron that contains `point`; on a shared face, one of its owners, always the same.
LatticeTet locate_in_lattice(const LatticeFrame& frame, const Vec3& point);

/// An injective 64-bit key of a node; coordinates within +-2^20.
constexpr std::uint64_t lattice_key(const LatticeNode& node) {
  constexpr std::int64_t kOffset = std::int64_t{1} << 20;
  return (static_cast<std::uint64_t>(node[0] + kOffset) << 42) | (static_cast<std::uint64_t>(node[1] + kOffset) << 21) |
         static_cast<std::uint64_t>(node[2] + kOffset);
}

}  // namespace softreel
