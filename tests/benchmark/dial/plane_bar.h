/// The bar of assets/bar.ply filled so that its pins end exactly where they are selected: for the truth of its motion.
#pragma once

#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/tet_mesh.h"
#include "tool/bodies/body_stage.h"

namespace softreel::bench {

/// Cubes cut in six, about `across` of them over the bar's thickness, with a plane of nodes at the end of each pinned
/// set of vertices. A pin that holds whole tetrahedra, anywhere in a lattice, reaches up to an edge further, which is
/// the main error of the bars that softreel fills itself; here it reaches no further along the bar, and what is left
/// of first order, that it holds a shell one tetrahedron thick, falls evenly.
FilledBody fill_to_planes(const SurfaceMesh& surface, const BodyConstraints& constraints, int across);

}  // namespace softreel::bench
