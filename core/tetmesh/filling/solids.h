/// Which parts of a surface bound one solid: bodies that only come near each other are filled apart, so that no lattice
/// can fuse them.
#pragma once

#include <vector>

#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/surface/surface_parts.h"

namespace softreel {

/// One solid: its triangles with the vertices that they use, and its parts with their names in the whole surface.
struct Solid {
  SurfaceMesh surface;  ///< positions and triangles only
  SurfaceParts parts;

  bool has_open_parts() const;
  /// That with the least volume for its area, but for those without any.
  const SurfacePart& thinnest_part() const;
};

/// Number of the solid of each part, from 0 in the order of their first part.
///
/// Two parts bound one solid if their triangles cross, or if one lies in the material of the other: a cavity does, and
/// a shell hidden inside; a ball in a cavity does not. Open parts have an inside only together with what is around
/// them: they are of one solid with every part whose box comes within 2 % of the larger diagonal.
std::vector<Index> find_solids(const SurfaceMesh& surface, const SurfaceParts& parts);

/// Per triangle the number of its solid, -1 for lines and points, of a surface whose parts may touch at vertices and
/// edges: its tetrahedra may be a piece for each. Where shells are open each counts by itself, as no one knows what
/// they enclose.
std::vector<Index> find_triangle_solids(const SurfaceMesh& surface);

/// The number of these solids.
Index count_solids(const SurfaceMesh& surface);

/// Takes the surface apart. solids: of find_solids.
std::vector<Solid> split_solids(const SurfaceMesh& surface, const SurfaceParts& parts,
                                const std::vector<Index>& solids);

}  // namespace softreel
