/// Triangles for formats whose vertices have one texture coordinate each: a vertex at a texture seam is there once for
/// each of its coordinates.
#pragma once

#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

struct SeamSplit {
  /// Per vertex, the vertex of the file that it is: first all of the file in order (used or not), then the duplicates.
  std::vector<Index> sources;
  std::vector<Triangle> triangles;  ///< into sources; as mesh.triangles, which are repaired
  std::vector<Vec2f> textures;      ///< per vertex, (0, 0) where it has none; empty if the file has none
};

/// A vertex keeps the coordinate of the first triangle corner that uses it; coordinates that are equal in float32 count
/// as one.
SeamSplit split_at_seams(const SurfaceMesh& mesh);

}  // namespace softreel
