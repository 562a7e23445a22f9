/// What of a surface is filled: its used vertices, joined ones in one place, its open parts thickened, its parts known.
#pragma once

#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/cells/embedded_lattice.h"
#include "core/tetmesh/surface/surface_parts.h"

namespace softreel {

struct PreparedSurface {
  SurfaceMesh surface;  ///< every vertex is used by a triangle
  SurfaceParts parts;
  Bounds box;
  /// The vertices of the surface as it was given, with their numbers in `surface`, -1 where it has none for them.
  std::vector<CarriedPoint> carried;
};

struct PreparationParams {
  double thickness = 0;  ///< of open parts, m; 0: they stay as they are
  /// Vertices in one place stay as many as the file has: what only touches is told apart by them. Else they become one.
  bool keep_vertices = false;
};

/// name: the body's, for messages. Throws input_error, one line,
/// for what has no volume to fill: no triangles, a flat surface, an open sheet without a thickness.
PreparedSurface prepare_surface(const SurfaceMesh& surface, const PreparationParams& params, const std::string& name,
                                const Log& log);

}  // namespace softreel
