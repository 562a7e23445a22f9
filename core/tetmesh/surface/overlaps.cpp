#include "core/tetmesh/surface/overlaps.h"

#include <array>
#include <cmath>

#include "core/tetmesh/key_index.h"
#include "core/tetmesh/surface/row_crossings.h"

namespace softreel {
namespace {

/// Cells are so many lattice units wide: some rows in each direction.
constexpr double kCell = 8;

/// A triangle whose box covers more cells is near everything.
constexpr std::int64_t kManyCells = 512;

/// Rows are crossed in so many slabs, one after the other.
constexpr std::int32_t kSlabs = 8;

using Cell = std::array<std::int64_t, 3>;

std::int64_t cell_of(double unit) {
  return static_cast<std::int64_t>(std::floor(unit / kCell));
}

/// Coordinates are below 2^20 in size.
std::uint64_t key_of(const Cell& cell) {
  constexpr std::int64_t kOffset = 1 << 20;
  std::uint64_t key = 0;
  for (const std::int64_t c : cell) key = key << 21 | static_cast<std::uint64_t>(c + kOffset);
  return key;
}

/// The box of the surface, lattice units.
Bounds lattice_box(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                   const LatticeFrame& frame) {
  Bounds box;
  for (const Triangle& triangle : triangles)
    for (const Index v : triangle)
      box.add((positions[static_cast<std::size_t>(v)] - frame.origin) * (2.0 / frame.spacing));
  return box;
}

/// Cells that rows pass through where the surface goes round them more than once. The rows are taken in slabs, as those
/// of a whole surface may take more memory than all that is filled into it.
KeyIndex overlapped_cells(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                          const LatticeFrame& frame) {
  const Bounds box = lattice_box(positions, triangles, frame);
  const auto low = static_cast<std::int32_t>(std::floor(box.min[2])) - 1,
             high = static_cast<std::int32_t>(std::ceil(box.max[2])) + 2;
  KeyIndex cells;
  for (std::int32_t slab = 0; slab < kSlabs; ++slab) {
    const auto begin_of = [&](std::int32_t s) { return low + (high - low) * s / kSlabs; };
    const RowCrossings rows(positions, triangles, frame, {begin_of(slab), begin_of(slab + 1)});
    rows.visit_overlaps([&](std::int32_t y, std::int32_t z, double begin, double end) {
      for (std::int64_t x = cell_of(begin); x <= cell_of(end); ++x) cells.insert(key_of({x, cell_of(y), cell_of(z)}));
    });
  }
  return cells;
}

/// Whether one of the cells of a box and of those beside them is in the set.
bool has_cell(const KeyIndex& cells, const Vec3& min, const Vec3& max) {
  Cell low, high;
  std::int64_t count = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = cell_of(min[static_cast<int>(k)]) - 1;
    high[k] = cell_of(max[static_cast<int>(k)]) + 1;
    count *= high[k] - low[k] + 1;
  }
  if (count > kManyCells) return true;
  for (std::int64_t x = low[0]; x <= high[0]; ++x)
    for (std::int64_t y = low[1]; y <= high[1]; ++y)
      for (std::int64_t z = low[2]; z <= high[2]; ++z)
        if (cells.find(key_of({x, y, z})) >= 0) return true;
  return false;
}

}  // namespace

std::vector<std::uint8_t> find_near_overlaps(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                                             const LatticeFrame& frame) {
  const KeyIndex cells = overlapped_cells(positions, triangles, frame);
  if (cells.size() == 0) return {};
  std::vector<std::uint8_t> near(triangles.size(), 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Bounds box;
    for (const Index v : triangles[t])
      box.add((positions[static_cast<std::size_t>(v)] - frame.origin) * (2.0 / frame.spacing));
    near[t] = has_cell(cells, box.min, box.max) ? 1 : 0;
  }
  return near;
}

}  // namespace softreel
