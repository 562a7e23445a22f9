/// Cuts polygons into triangles: concave ones, quads and slightly bent ones included.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// n - 2 triangles, oriented as the polygon, as indices into `corners` (at least 3).
///
/// A quad is cut along its shorter diagonal, unless only the other one lies inside. More corners: ear clipping
/// (Meisters 1975) in the plane of the area vector, which for a simple planar polygon covers exactly its inside. Bent
/// or self-crossing polygons are cut too, with whatever triangles remain; a polygon without area becomes a fan. Cost:
/// little more than n log n of evenly spread corners; of reflex corners that crowd in one place, their number n times.
std::vector<Triangle> triangulate_polygon(std::span<const Vec3> corners);

/// Fills triangles, triangle_polygon and triangle_textures from the polygons. Polygons with a vertex that is not finite
/// get no triangles; returns their number.
std::int64_t triangulate_polygons(SurfaceMesh& mesh);

}  // namespace softreel
