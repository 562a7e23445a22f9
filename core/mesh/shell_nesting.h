/// Which closed shells of a surface lie inside of which others, and which of them point the wrong way.
#pragma once

#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Marks the pieces to turn so that solids point outward and cavities inward.
///
/// piece: of each triangle; closed: of each piece (others are never marked). A shell that nothing contains must have
/// positive volume. One inside of another is left as it stood relative to the innermost shell that contains it: against
/// it (a cavity) or like it (a solid in a solid). So is one inside of an open piece, which stays: inside is where the
/// winding number of that piece alone is above 1/2 in size, as it is behind the eyes of a head that ends at the neck.
/// Shells without volume are not marked.
/// Cost: a ray through the possible containers of each shell; for those that would be turned also the winding numbers
/// of the largest open pieces round them, logarithmic in their triangles.
std::vector<char> find_inverted_shells(const SurfaceMesh& mesh, const std::vector<Index>& piece,
                                       const std::vector<char>& closed);

}  // namespace softreel
