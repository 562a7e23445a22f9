/// What every mesh that is made promises, looked at in every build: elements, angles, boundary, pieces.
#pragma once

#include <string>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Dihedral angles that a mesh promises, degrees.
struct AngleBounds {
  double min, max;
};

/// Throws work_error if an element has no volume or angles beyond the bounds. name: the body's.
void require_quality(const TetMesh& mesh, const AngleBounds& bounds, const std::string& name, const Threads& threads);

/// Throws work_error if the boundary is no manifold.
void require_manifold(const TetMesh& mesh, const std::string& name);

/// Throws input_error, with the edge length that should do, if the tetrahedra of one solid are more pieces than its
/// surface has shells: it is too thin somewhere. edge: of the tetrahedra there, m.
void require_whole(const TetMesh& mesh, const SurfaceMesh& solid, double edge, const std::string& part,
                   const std::string& name);

}  // namespace softreel
