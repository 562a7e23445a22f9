/// The lattice tetrahedra that a surface passes, and which of its triangles each of them meets.
#pragma once

#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/cells/bcc_cells.h"
#include "core/tetmesh/cells/cell_clipping.h"
#include "core/tetmesh/surface/surface_parts.h"

namespace softreel {

/// A surface seen from a lattice: what its triangles are connected by. Triangles that are collapsed or not finite have
/// no connections and are left out of everything.
struct LatticeSurface {
  LatticeFrame frame;
  std::vector<Vec3> points;         ///< lattice units
  std::vector<Triangle> triangles;  ///< the whole encloses a positive volume: turned round if it did not
  std::vector<bool> used;           ///< per triangle
  /// Per side of a triangle (from corner k): sides with the same number are connected. Where two triangles meet at an
  /// edge they are; where more do, those that share its vertices in the file: what only touches stays parted.
  std::vector<std::array<Index, 3>> joints;
  std::vector<std::uint8_t> rims;  ///< per triangle: bit k if the edge of side k is not balanced, an end of the surface
  std::vector<Index> parts;        ///< per triangle: its part of the surface
  bool closed = true;              ///< no rims

  Vec3 world(const Vec3& point) const { return frame.origin + 0.5 * frame.spacing * point; }
};

LatticeSurface make_lattice_surface(const SurfaceMesh& surface, const SurfaceParts& parts, const LatticeFrame& frame);

/// A triangle in a cell.
struct CellCut {
  std::uint64_t cell;  ///< cell_key
  Index triangle;
  std::uint8_t faces = 0;   ///< bit k: crosses face k of the cell
  std::uint8_t sides = 0;   ///< bit k: its side k passes the cell
  std::uint8_t points = 0;  ///< bit k: its corner k lies in the cell
  double volume_share = 0;  ///< ClippedTriangle::volume_share
};

/// Barycentric weights of a triangle's corners in a cell.
std::array<Vec4, 3> triangle_weights(const LatticeSurface& surface, Index triangle, const BccCell& cell);

/// All pairs of a cell and a triangle that overlap, margin included, sorted by cell, then triangle. The tests are
/// exact but for the margin. Cost: linear in the pairs, and in the boxes of small triangles.
std::vector<CellCut> cut_cells(const LatticeSurface& surface, const Threads& threads);

}  // namespace softreel
