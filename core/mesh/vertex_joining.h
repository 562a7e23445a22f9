/// Joins vertices that were meant to be one: rims of a surface that nearly meet, as exporters leave them that round
/// each triangle for itself.
#pragma once

#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Per vertex the vertex that stands for it: the first one of exactly its position (weld_positions), or, on the rims of
/// open edges, the first one that is nearer than 1e-5 of the diagonal of the box and than a quarter of the shortest
/// edge there. Positions are not changed. `joined`: number of places that were not equal but are one now.
/// Cost: a sort of the edges, and of the vertices on rims.
std::vector<Index> join_vertices(const SurfaceMesh& mesh, std::int64_t& joined);

}  // namespace softreel
