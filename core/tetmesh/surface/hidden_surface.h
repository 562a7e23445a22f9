/// What of a surface lies inside the solid because pieces of it overlap: no part of the solid's boundary.
#pragma once

#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {

/// The surface without what has the solid on both sides: winding numbers of 1 or more (or -1 and less) just in front of
/// and behind it. Triangles for which suspected[t] is 0 are kept unseen; suspected ones are cut to pieces
/// (surface_pieces.h) of edges of at most `step` (m) at the border of what is hidden, and of four, or 1/128 of the
/// box's diagonal, where another triangle crosses them. Positions stay, new ones come after them; only positions and
/// triangles are filled in. Cost: eight winding numbers a piece.
SurfaceMesh without_hidden(const SurfaceMesh& surface, const std::vector<std::uint8_t>& suspected, double step,
                           const Threads& threads);

}  // namespace softreel
