/// The connected parts of a solid within one lattice tetrahedron, and the volume of each.
///
/// Parts are found from the surface, not from samples, so that nothing is too thin: clipped triangles that are joined
/// by an edge within the cell bound one part; so do two that see each other through the solid, straight behind the one
/// (the two sides of a plate) or by way of points inside. Only cells with more than one such patch need the latter. A
/// connected surface therefore always has connected cells: what is joined is never lost, whatever the lattice.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/mesh/winding_number.h"
#include "core/tetmesh/cells/cut_cells.h"
#include "core/tetmesh/lattice/lattice_nodes.h"
#include "core/tetmesh/surface/row_crossings.h"

namespace softreel {

/// What is inside: exact at lattice nodes, generalised winding numbers elsewhere. Reading is thread-safe.
class SolidInside {
 public:
  SolidInside(const LatticeSurface& surface, const SurfaceMesh& mesh, const Threads& threads);

  const std::vector<LatticeNode>& nodes() const { return inside_.nodes(); }  ///< those inside, numbered
  bool contains(const LatticeNode& node) const { return inside_.contains(node); }

  /// Winding number of a lattice node; of an open surface 1 inside and 0 outside.
  int winding(const LatticeNode& node) const;
  /// Winding number of a point (lattice units), positive inside but for parts that are inside out.
  double winding(const Vec3& point) const { return winding_(surface_.world(point)); }
  /// The same but for round-off, and quicker.
  double quick_winding(const Vec3& point) const { return winding_.quick(surface_.world(point)); }

 private:
  const LatticeSurface& surface_;
  LatticeNodeSet inside_;
  std::optional<RowCrossings> crossings_;  ///< of a closed surface
  WindingNumber winding_;
};

/// Parts of one cell, numbered by their first triangle.
struct CellParts {
  Index count = 1;
  std::array<Index, 4> corners{-1, -1, -1, -1};  ///< part at each corner, -1 outside
  std::vector<double> fills;                     ///< per part: its share of the cell's volume, 0 to 1
};

/// Splits the solid in a cell. cuts: the triangles in it, may be none; cut_parts: the part of each, written.
///
/// Fills are exact but for round-off where the surface is closed and simple in the cell; else they are the share of
/// points inside, of kFillSamples, of which each belongs to the part of the nearest triangle.
CellParts find_cell_parts(const LatticeSurface& surface, const SolidInside& inside, const BccCell& cell,
                          std::span<const CellCut> cuts, std::span<Index> cut_parts);

/// Per point of the cell (lattice units) the cut whose triangle is nearest to it, within the cell: a point of the solid
/// is in its part. There must be one.
std::vector<std::size_t> nearest_cuts_in_cell(const LatticeSurface& surface, const BccCell& cell,
                                              std::span<const CellCut> cuts, std::span<const Vec3> points);

/// Points that stand for a cell where its fill is not exact: an error of about 1 %.
constexpr std::size_t kFillSamples = 56;

}  // namespace softreel
