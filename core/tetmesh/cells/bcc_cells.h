/// The tetrahedra of the BCC lattice by number: corners, neighbours across faces, barycentric weights.
///
/// A cell is named by the lower of its two cube centres, the axis from there to the upper one, and the edge of the
/// square between them. Points are in lattice units (half the spacing, from the lattice's origin).
#pragma once

#include <array>
#include <cstdint>

#include "core/tetmesh/lattice/bcc_lattice.h"

namespace softreel {

/// Twelve types: axis * 4 + edge of the square between the centres.
constexpr std::size_t kCellTypes = 12;

struct BccCell {
  LatticeNode center;     ///< the lower cube centre: all odd
  std::uint8_t type = 0;  ///< axis * 4 + edge

  bool operator==(const BccCell&) const = default;
};

/// Corners: lower centre, upper centre, ends of the edge; positively oriented.
std::array<LatticeNode, 4> cell_corners(const BccCell& cell);

/// An injective key; center within +-2^20.
std::uint64_t cell_key(const BccCell& cell);
BccCell cell_of_key(std::uint64_t key);

/// The cell on the other side of a face.
struct CellNeighbor {
  BccCell cell;
  std::size_t face;                    ///< the shared face there
  std::array<std::uint8_t, 4> corner;  ///< per own corner, its number there; meaningless for the one opposite the face
};

/// Neighbour across face k, which lies opposite corner k.
CellNeighbor cell_neighbor(const BccCell& cell, std::size_t face);

/// The 24 cells around a lattice node.
std::array<BccCell, 24> cells_around(const LatticeNode& node);

/// Barycentric weights of a point (lattice units) in a cell.
Vec4 cell_weights(const BccCell& cell, const Vec3& point);

/// The cell that contains a point (lattice units).
BccCell cell_at(const Vec3& point);

}  // namespace softreel
