/// Lines along the edges of triangles, as the camera sees them.
#pragma once

#include "render/pathtrace/rays/surface_point.h"

namespace softreel {

/// Whether a camera ray that hit a triangle of `mesh` meets a line of mesh.lines, which must be there.
/// pixel: m, edge of a pixel one metre ahead of the camera. Thread-safe.
bool on_edge_line(const MotionMesh& mesh, const RayHit& hit, const Ray& ray, float pixel);

}  // namespace softreel
