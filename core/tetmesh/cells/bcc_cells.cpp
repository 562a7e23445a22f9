#include "core/tetmesh/cells/bcc_cells.h"

#include <algorithm>

#include "core/base/check.h"

namespace softreel {
namespace {

struct Axes {
  std::size_t c, a, b;  // from centre to centre, and across
};

Axes axes_of(const BccCell& cell) {
  const std::size_t c = cell.type / 4U;
  return {c, (c + 1) % 3, (c + 2) % 3};
}

/// Corners of the square between two centres, along a and b, in the order of its edges.
constexpr std::array<std::array<std::int32_t, 2>, 4> kSquare{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};

bool has(const std::array<LatticeNode, 4>& corners, const LatticeNode& node) {
  return std::find(corners.begin(), corners.end(), node) != corners.end();
}

/// The neighbours of the cell of each type with centre (1, 1, 1), found by comparing corners.
std::array<std::array<CellNeighbor, 4>, kCellTypes> find_neighbors() {
  std::array<std::array<CellNeighbor, 4>, kCellTypes> table{};
  for (std::uint8_t type = 0; type < kCellTypes; ++type) {
    const BccCell cell{{1, 1, 1}, type};
    const std::array<LatticeNode, 4> corners = cell_corners(cell);
    for (std::size_t face = 0; face < 4; ++face) {
      const LatticeNode& on_face = corners[(face + 1) % 4];
      for (const BccCell& other : cells_around(on_face)) {
        if (other == cell) continue;
        const std::array<LatticeNode, 4> others = cell_corners(other);
        CellNeighbor found{other, 0, {}};
        std::size_t shared = 0;
        for (std::size_t k = 0; k < 4; ++k) {
          const auto place = std::find(others.begin(), others.end(), corners[k]);
          if (k == face || place == others.end()) continue;
          found.corner[k] = static_cast<std::uint8_t>(place - others.begin());
          ++shared;
        }
        if (shared != 3) continue;
        while (has(corners, others[found.face])) ++found.face;
        table[type][face] = found;
      }
    }
  }
  return table;
}

}  // namespace

std::array<LatticeNode, 4> cell_corners(const BccCell& cell) {
  const auto [c, a, b] = axes_of(cell);
  std::array<LatticeNode, 4> corners{cell.center, cell.center, cell.center, cell.center};
  corners[1][c] += 2;
  for (std::size_t end = 0; end < 2; ++end) {
    const auto& square = kSquare[(cell.type + end) % 4];
    corners[2 + end][c] += 1;
    corners[2 + end][a] += square[0];
    corners[2 + end][b] += square[1];
  }
  return corners;
}

std::uint64_t cell_key(const BccCell& cell) {
  constexpr std::int32_t kOffset = 1 << 19;
  std::uint64_t key = 0;
  for (const std::int32_t x : cell.center) key = key << 20 | static_cast<std::uint32_t>((x >> 1) + kOffset);
  return key << 4 | cell.type;
}

BccCell cell_of_key(std::uint64_t key) {
  constexpr std::int32_t kOffset = 1 << 19;
  BccCell cell{{}, static_cast<std::uint8_t>(key & 15)};
  key >>= 4;
  for (std::size_t k = 3; k-- > 0; key >>= 20)
    cell.center[k] = 2 * (static_cast<std::int32_t>(key & ((1 << 20) - 1)) - kOffset) + 1;
  return cell;
}

CellNeighbor cell_neighbor(const BccCell& cell, std::size_t face) {
  static const auto table = find_neighbors();
  CellNeighbor neighbor = table[cell.type][face];
  for (std::size_t k = 0; k < 3; ++k) neighbor.cell.center[k] += cell.center[k] - 1;
  return neighbor;
}

std::array<BccCell, 24> cells_around(const LatticeNode& node) {
  std::array<BccCell, 24> cells;
  std::size_t count = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::uint8_t k = 0; k < 4; ++k) {
      BccCell cell{node, static_cast<std::uint8_t>(4 * axis + k)};
      if ((node[0] & 1) != 0) {  // a centre: lower or upper
        cells[count++] = cell;
        cell.center[axis] -= 2;
        cells[count++] = cell;
      } else {  // the end of two edges of each square around it
        cell.center[axis] -= 1;
        cell.center[(axis + 1) % 3] -= kSquare[k][0];
        cell.center[(axis + 2) % 3] -= kSquare[k][1];
        cells[count++] = cell;
        cell.type = static_cast<std::uint8_t>(4 * axis + (k + 3U) % 4U);
        cells[count++] = cell;
      }
    }
  return cells;
}

Vec4 cell_weights(const BccCell& cell, const Vec3& point) {
  const auto [c, a, b] = axes_of(cell);
  const auto along = [&](std::size_t k) { return point[static_cast<Index>(k)] - cell.center[k]; };
  const double x = along(c), u = along(a), v = along(b);
  // y: from the line of the centres out to the edge; z: along the edge.
  double y = 0, z = 0;
  switch (cell.type % 4) {
    case 0:
      y = -v, z = u;
      break;
    case 1:
      y = u, z = v;
      break;
    case 2:
      y = v, z = -u;
      break;
    default:
      y = -u, z = -v;
      break;
  }
  return {1.0 - 0.5 * (x + y), 0.5 * (x - y), 0.5 * (y - z), 0.5 * (y + z)};
}

BccCell cell_at(const Vec3& point) {
  const LatticeTet tet = locate_in_lattice({Vec3::Zero(), 2.0}, point);
  for (const BccCell& cell : cells_around(tet.nodes[0])) {
    const std::array<LatticeNode, 4> corners = cell_corners(cell);
    if (std::all_of(tet.nodes.begin(), tet.nodes.end(), [&](const LatticeNode& n) { return has(corners, n); }))
      return cell;
  }
  CHECK(false);
  return {};
}

}  // namespace softreel
