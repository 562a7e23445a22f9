/// What every mesh that is made promises, looked at in every build: elements, angles, boundary, pieces.
#pragma once

#include <string>

#include "core/base/log.h"
#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/filling/solids.h"
#include "core/tetmesh/stuffing/isosurface_stuffing.h"
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

/// Says where that of an embedded mesh is none.
void say_joined_limbs(const TetMesh& mesh, const std::string& name, const Log& log);

/// Pieces that are connected through faces.
Index count_pieces(const TetMesh& mesh);

/// Whether the tetrahedra made of one surface are no more pieces than it has solids (solids.h).
bool is_whole(const TetMesh& mesh, const SurfaceMesh& surface);

/// Throws input_error, with the edge length that should do, if they are not: it is too thin somewhere. edge: of the
/// tetrahedra there, m.
void require_whole(const TetMesh& mesh, const SurfaceMesh& solid, double edge, const std::string& part,
                   const std::string& name);

/// Tunnels of a solid's boundary that its surface does not have: a thin wall is perforated, or limbs grew together. 0
/// where that is not known, as the surface is open, or of several parts, which together may have tunnels that none of
/// them has. The boundary must be a manifold.
Index count_new_tunnels(const StuffedMesh& stuffed, const Solid& solid);
/// Warns of them.
void warn_of_tunnels(const StuffedMesh& stuffed, const Solid& solid, const std::string& name, const Log& log);

/// Warns if the tetrahedra of a solid that is one closed part have more volume than it, or less; of several, if they
/// have more than all of these together.
void warn_of_volume(const TetMesh& mesh, const Solid& solid, const std::string& name, const Threads& threads,
                    const Log& log);

/// Throws input_error if they leave out much of it, far from where they are.
void require_most_of(const TetMesh& mesh, const Solid& solid, const std::string& name, const Threads& threads);

}  // namespace softreel
