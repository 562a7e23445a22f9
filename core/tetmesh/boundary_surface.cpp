#include "core/tetmesh/boundary_surface.h"

namespace softreel {

SurfaceMesh boundary_surface(const TetMesh& mesh) {
  SurfaceMesh surface;
  surface.positions = mesh.nodes;
  surface.triangles = boundary_faces(mesh);
  for (const Triangle& triangle : surface.triangles) {
    surface.triangle_polygon.push_back(static_cast<Index>(surface.triangle_polygon.size()));
    surface.polygons.corner_vertices.insert(surface.polygons.corner_vertices.end(), triangle.begin(), triangle.end());
    surface.polygons.offsets.push_back(static_cast<Index>(surface.polygons.corner_vertices.size()));
  }
  return surface;
}

}  // namespace softreel
