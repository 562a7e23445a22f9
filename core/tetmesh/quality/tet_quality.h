/// How good tetrahedra are: dihedral angles, volumes, and how far their boundary is from a surface.
#pragma once

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

struct TetQuality {
  double min_dihedral = 0, max_dihedral = 0;  ///< degrees
  double first_percentile_dihedral = 0;       ///< degrees: 1 % of the elements have a smaller least angle
  Index min_dihedral_tet = -1, max_dihedral_tet = -1;
  double volume = 0, min_volume = 0;  ///< m^3: of the material of all; of the smallest element, filled or not
  Index min_volume_tet = -1;
};

/// Smallest and largest dihedral angle of one tetrahedron, radians. NaN for one without volume.
struct DihedralRange {
  double min, max;
};
DihedralRange dihedral_range(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Measures all elements; node indices must be valid. Of a mesh without elements: all 0 and -1.
TetQuality measure_quality(const TetMesh& mesh, const Threads& threads);

/// Largest distances between a surface and the boundary of a mesh, m: at all points of the triangles of either, as
/// far as farthest_distance finds them. Vertices that no triangle uses do not count. Where pieces of the surface
/// overlap, what has the solid on both sides is no boundary of it and is left out (hidden_surface.h); only triangles
/// that are further away than any point of the boundary is from the surface are looked at for that, so that clean
/// surfaces cost nothing. Where the boundary closes a hole of an open surface (hole_caps.h) it has no surface to
/// follow, and is left out too.
struct SurfaceDeviation {
  double from_surface = 0;   ///< largest distance of a point of the surface to the boundary of the mesh
  double from_boundary = 0;  ///< largest distance of a point of the boundary to the surface
  double cap_share = 0;      ///< of the boundary's area: what closes holes and is not measured, 0 to 1
  double two_way() const { return from_surface > from_boundary ? from_surface : from_boundary; }
};
SurfaceDeviation measure_deviation(const SurfaceMesh& surface, const TetMesh& mesh, const Threads& threads);

}  // namespace softreel
