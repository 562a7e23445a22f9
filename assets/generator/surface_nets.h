/// The surface of a sculpture as a closed, evenly meshed manifold.
#pragma once

#include "assets/generator/sculpture.h"
#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"

namespace softreel::sculpt {

/// Naive surface nets (S. Gibson, "Constrained elastic surface nets", 1998), relaxed along the isosurface.
///
/// One vertex for each sheet of surface in a lattice cell, one quadrilateral for each lattice edge it cuts; then
/// `relaxations` rounds of moving every vertex to the mean of its neighbours and back onto the surface. Quadrilaterals
/// are cut along their shorter diagonal. Gives positions, triangles and the parts as groups; the same bits at every
/// run. Throws work_error if the result is not one closed manifold (the cell is too coarse for a detail).
SurfaceMesh mesh_surface(const Sculpture& sculpture, int relaxations, const Threads& threads);

}  // namespace softreel::sculpt
