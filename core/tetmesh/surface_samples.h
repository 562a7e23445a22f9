/// Points all over a surface.
#pragma once

#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Points of a surface: its used vertices, and a grid with steps of at most `step` over triangles with longer edges. In
/// the order of the triangles in `order`, which should be that of a tree: neighbours are to be near in memory.
std::vector<Vec3> sample_surface(const SurfaceMesh& surface, const std::vector<Index>& order, double step);

/// The same, each place once: those on an edge come with the first of its triangles. About a third as many.
std::vector<Vec3> sample_surface_once(const SurfaceMesh& surface, const std::vector<Index>& order, double step);

}  // namespace softreel
