/// Triangles without what a rule leaves out, cut to pieces where the rule's border passes.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Whether a point of a triangle, whose corners come first, is left out. Called from several threads.
using LeavesOut = std::function<bool(const std::array<Vec3, 3>&, const Vec3&)>;

/// The triangles without the pieces that are left out. Those for which suspected[t] is 0 are kept unseen. Suspected
/// ones are judged by their middles, and quartered where their corners disagree until their edges are at most `step`
/// (m) long, six times at most. Positions stay, new ones come after them; only positions and triangles are filled in.
SurfaceMesh without_pieces(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                           const std::vector<std::uint8_t>& suspected, double step, const LeavesOut& leaves_out,
                           const Threads& threads);

}  // namespace softreel
