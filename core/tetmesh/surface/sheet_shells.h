/// Gives open sheets a thickness, so that there is a volume to fill.
#pragma once

#include <cstdint>

#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/surface/surface_parts.h"

namespace softreel {

/// Replaces every open part of the surface by the closed skin of all points within thickness / 2 of it along its
/// normals: two sheets, and a wall along the rim. Normals are found edge by edge with the sign of each triangle's own,
/// so that one-sided sheets and sheets that meet in threes work too. Vertices are welded where they are equal; groups
/// and texture coordinates are dropped. thickness: above 0, m. Returns the number of triangles that were open.
std::int64_t thicken_sheets(SurfaceMesh& surface, const SurfaceParts& parts, double thickness);

}  // namespace softreel
