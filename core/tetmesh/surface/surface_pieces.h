/// Triangles without what a rule leaves out, cut to pieces where the rule's border passes.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Whether a point of a triangle, whose corners come first, is left out. Called from several threads.
using LeavesOut = std::function<bool(const std::array<Vec3, 3>&, const Vec3&)>;

/// Lengths of edges, m. A triangle is judged by its middle where its corners agree and its edges are at most `trusted`
/// long: what is left out may lie inside of a larger one and reach to none of them. Others are quartered until their
/// edges are at most `border` long.
struct PieceSizes {
  double border = 0;
  double trusted = std::numeric_limits<double>::infinity();
  int most_quarterings = 6;
};

/// The triangles without the pieces that are left out. Those for which suspected[t] is 0 are kept unseen. Positions
/// stay, new ones come after them; only positions and triangles are filled in.
SurfaceMesh without_pieces(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                           const std::vector<std::uint8_t>& suspected, const PieceSizes& sizes,
                           const LeavesOut& leaves_out, const Threads& threads);

}  // namespace softreel
