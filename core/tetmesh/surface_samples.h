/// Points all over a surface.
#pragma once

#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Points of a surface: its used vertices, and a grid with steps of at most `step` over triangles with longer edges. In
/// the order of the triangles in `order`, which should be that of a tree: neighbours are to be near in memory.
std::vector<Vec3> sample_surface(const SurfaceMesh& surface, const std::vector<Index>& order, double step);

/// The same with each point once: an edge is sampled by its own length and for all its triangles. Fewer by a half or
/// more where triangles are about as long as the step.
std::vector<Vec3> sample_surface_once(const SurfaceMesh& surface, const std::vector<Index>& order, double step);

/// Puts some points first, about one in each cube of this width, and leaves both kinds in their order. Returns how many
/// they are.
std::size_t put_coarse_first(std::vector<Vec3>& points, double width);

}  // namespace softreel
