/// Exact winding numbers of lattice nodes round a closed surface: where rows of nodes along x cross its triangles.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include "core/base/number_table.h"
#include "core/tetmesh/lattice/lattice_nodes.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {

/// The rows with z in [begin, end), lattice units.
struct RowRange {
  std::int32_t begin = std::numeric_limits<std::int32_t>::min(), end = std::numeric_limits<std::int32_t>::max();
};

/// All crossings of the rows of a lattice with a surface. Every edge is decided from its own two ends alone, the same
/// for all its triangles, so that a closed surface gives integers that change nowhere but at the surface, whatever the
/// round-off. Linear in triangles and crossings; reading is thread-safe.
class RowCrossings {
 public:
  /// Of all rows, or of those in a range.
  RowCrossings(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles, const LatticeFrame& frame,
               const RowRange& rows = {});

  /// How often the surface goes round a node; meaningful if every edge is used as often in one direction as in the
  /// other.
  int winding(const LatticeNode& node) const;

  /// Calls visit(y, z, first x, last x), lattice units, where rows pass through what the surface goes round more than
  /// once.
  template <typename Visit>
  void visit_overlaps(const Visit& visit) const;

  /// Calls visit(node) for all nodes with a winding number other than 0, row by row.
  template <typename Visit>
  void visit_inside(const Visit& visit) const;

 private:
  /// A row meets a triangle at x (lattice units); +1 if it leaves the inside there in the direction of +x.
  struct Crossing {
    std::int32_t z, y;
    double x;
    int sign;
  };
  using Corner = std::array<double, 3>;

  void cross_triangle(const std::array<Corner, 3>& corners, const RowRange& rows);
  const Crossing& first_of_row(Index row) const {
    return crossings_[static_cast<std::size_t>(row_begins_[static_cast<std::size_t>(row)])];
  }

  std::vector<Crossing> crossings_;  // by row, then x
  NumberTable table_;                // of rows
  std::vector<Index> row_begins_;    // rows + 1
};

template <typename Visit>
void RowCrossings::visit_inside(const Visit& visit) const {
  for (std::size_t r = 0; r + 1 < row_begins_.size(); ++r) {
    int winding = 0;
    for (Index c = row_begins_[r]; c + 1 < row_begins_[r + 1]; ++c) {
      const Crossing &from = crossings_[static_cast<std::size_t>(c)], &to = crossings_[static_cast<std::size_t>(c) + 1];
      winding -= from.sign;
      if (winding == 0) continue;
      auto x = static_cast<std::int32_t>(std::ceil(from.x));
      x += (x ^ from.y) & 1;
      for (; x < to.x; x += 2) visit(LatticeNode{x, from.y, from.z});
    }
  }
}

template <typename Visit>
void RowCrossings::visit_overlaps(const Visit& visit) const {
  for (std::size_t r = 0; r + 1 < row_begins_.size(); ++r) {
    int winding = 0;
    for (Index c = row_begins_[r]; c + 1 < row_begins_[r + 1]; ++c) {
      const Crossing &from = crossings_[static_cast<std::size_t>(c)], &to = crossings_[static_cast<std::size_t>(c) + 1];
      winding -= from.sign;
      if (std::abs(winding) > 1) visit(from.y, from.z, from.x, to.x);
    }
  }
}

/// RowCrossings::winding of one node, found in the tree of a closed surface: for nodes of many sizes, where most rows
/// of the finest lattice hold none. Cost: the triangles that its row meets, and the boxes round them.
int winding_of_node(const TriangleTree& tree, const LatticeFrame& frame, const LatticeNode& node);

}  // namespace softreel
