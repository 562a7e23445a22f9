/// Tetrahedra that fill the inside part of one lattice tetrahedron, per sign pattern of its nodes.
///
/// Labelle and Shewchuk, Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles, 2007, figure 3. The
/// tables are made by the compiler from the rules, so that there is nothing to mistype.
#pragma once

#include <array>
#include <cstdint>

namespace softreel {

/// Where a lattice node lies.
enum class NodeSign : std::int8_t { Inside = -1, Surface = 0, Outside = 1 };

/// A stencil vertex: 0..3 a node of the lattice tetrahedron, 4 + e the cut of its edge e.
using StencilTet = std::array<std::uint8_t, 4>;

/// At most three tetrahedra, positively oriented if the lattice tetrahedron is.
struct CutStencil {
  std::uint8_t count = 0;
  std::array<StencilTet, 3> tets{};
};

/// Node pairs of the 6 edges; the first two are long. Nodes 0 and 2 are the ends of their long edge whose sum of halved
/// coordinates is even: the parity rule reads them.
constexpr std::array<std::array<std::uint8_t, 2>, 6> kStencilEdges{{{0, 1}, {2, 3}, {0, 2}, {0, 3}, {1, 2}, {1, 3}}};

/// The stencil of a sign pattern; signs are those of nodes 0..3. Two lattice tetrahedra that share a face split it
/// alike.
const CutStencil& cut_stencil(const std::array<NodeSign, 4>& signs);

/// How faces with two inside nodes are split in tetrahedra of other shapes.
struct DiagonalRule {
  /// [p][q][r]: the face with p, q inside and r outside is split along p - cut(q, r) if true, along q - cut(p, r) if
  /// not. Must say the same for both tetrahedra of a face, the opposite for [q][p][r], and for one r put the other
  /// three nodes in an order.
  std::array<std::array<std::array<bool, 4>, 4>, 4> starts_at_first{};
};

/// The stencil of any tetrahedron that follows a rule of its own.
CutStencil cut_stencil(const std::array<NodeSign, 4>& signs, const DiagonalRule& rule);

}  // namespace softreel
