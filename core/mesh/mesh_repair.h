/// Makes the triangles of a surface fit for inside and outside: no junk, one orientation, outward.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Repairs `triangles` (with triangle_polygon and triangle_textures) in place; vertices, polygons, groups and their
/// order are the file's and stay. Returns one line for each kind of repair that changed something. In this order:
/// - rims that nearly meet are joined (see join_vertices), by SurfaceMesh::joined alone;
/// - triangles with vertices that are not finite, or with two corners in one place, are removed. Triangles without area
///   but with three distinct corners stay: they close the surface;
/// - of triangles on the same three places the first one stays; a wall inside of a body whose faces are there once for
///   each side (a patch of opposite twins that ends at edges of three faces, as between two boxes that share a side) is
///   removed with both, which changes neither inside nor outside and closes the rest;
/// - neighbours across edges of two triangles are made to agree, the minority of a piece giving way to the majority (by
///   area); one-sided pieces (Moebius strips) stay;
/// - closed pieces are turned outward. A piece inside of another, closed or open, stays a cavity if it was oriented
///   against its container, and solid if it was oriented like it.
/// Cost: two sorts, and what find_inverted_shells takes.
std::vector<std::string> repair_mesh(SurfaceMesh& mesh);

}  // namespace softreel
