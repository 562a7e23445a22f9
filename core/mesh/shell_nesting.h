/// Which closed shells of a surface lie inside of which others, and which of them point the wrong way.
#pragma once

#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Marks the pieces to turn so that solids point outward and cavities inward.
///
/// piece: of each triangle; closed: of each piece (others are never marked, and contain nothing). A shell that no other
/// one contains must have positive volume. One inside of another is left as it stood relative to the innermost shell
/// that contains it: against it (a cavity) or like it (a solid in a solid). Shells without volume are not marked.
std::vector<char> find_inverted_shells(const SurfaceMesh& mesh, const std::vector<Index>& piece,
                                       const std::vector<char>& closed);

}  // namespace softreel
