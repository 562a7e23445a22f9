/// A triangle clipped to a lattice tetrahedron: what of it lies there, and its share of the volume it bounds.
#pragma once

#include <array>
#include <cstdint>

#include "core/tetmesh/cells/bcc_cells.h"

namespace softreel {

/// Cells count as larger than they are by this barycentric weight, so that round-off leaves no gap between them.
constexpr double kCellMargin = 1e-9;

/// The convex polygon that is left of a triangle: barycentric weights of its corners, and what each of its edges lies
/// on: face 0..3 of the cell, or edge 0..2 of the triangle (kOwnEdge + k, from corner k on).
struct ClippedTriangle {
  static constexpr std::uint8_t kOwnEdge = 4;
  static constexpr std::size_t kMostCorners = 16;  // 3 and one more per face, twice that if round-off bends it

  std::size_t count = 0;  ///< 0: the triangle misses the cell
  std::array<Vec4, kMostCorners> corners;
  std::array<std::uint8_t, kMostCorners> edges;  ///< from corner i to i + 1

  /// Its term in the volume of what the surface encloses of the cell, as a share of the cell. With the terms of all
  /// triangles and the winding number of corner 3, the sum is the integral of the winding number over the cell: cones
  /// from corner 0 over the clipped triangles and over the inside of face 0, whose area is that of triangles from
  /// corner 1 over the cuts with it and over the inside of the edge from corner 2 to 3. Exact but for round-off, and
  /// the same decisions on either side of an edge, for an edge is cut from its inner end to its outer one.
  double volume_share = 0;

  bool has_edge(std::size_t k) const { return has(static_cast<std::uint8_t>(kOwnEdge + k)); }
  bool has_face(std::size_t k) const { return has(static_cast<std::uint8_t>(k)); }

 private:
  bool has(std::uint8_t edge) const;
};

/// weights: barycentric weights of the triangle's corners in the cell (cell_weights).
ClippedTriangle clip_to_cell(const std::array<Vec4, 3>& weights);

/// True if a point with these weights is in the cell, margin included.
inline bool in_cell(const Vec4& weights) {
  return weights.minCoeff() >= -kCellMargin;
}

}  // namespace softreel
