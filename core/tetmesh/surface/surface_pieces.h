/// Triangles without what a rule leaves out, cut to pieces where the rule's border passes.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {

using TriangleCorners = std::array<Vec3, 3>;

/// What is left out of triangles, and how finely that is looked for. Both are called from several threads.
struct PieceRules {
  /// Whether a point of a piece is left out.
  std::function<bool(const TriangleCorners& piece, const Vec3& point)> leaves_out;
  /// Whether the border of what is left out may pass through a piece of a triangle; none: nobody knows.
  std::function<bool(const TriangleCorners& triangle, const TriangleCorners& piece)> may_differ;
  double border = 0;  ///< m; edges of the pieces along the border
  /// m; pieces of such edges, which may differ, are judged by their middles where their corners agree: what is left out
  /// may lie inside of a larger one and reach to none of them.
  double trusted = std::numeric_limits<double>::infinity();
  int most_quarterings = 6;
};

/// The triangles without the pieces that are left out. Those for which suspected[t] is 0 are kept unseen. Positions
/// stay, new ones come after them; only positions and triangles are filled in.
SurfaceMesh without_pieces(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                           const std::vector<std::uint8_t>& suspected, const PieceRules& rules, const Threads& threads);

}  // namespace softreel
