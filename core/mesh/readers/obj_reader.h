/// Wavefront OBJ: vertices, polygons, texture coordinates and names in the order of the file.
#pragma once

#include "core/mesh/readers/mesh_source.h"

namespace softreel::detail {

/// Reads v, vt, f, g, o and usemtl; every other statement (normals, lines, curves, smoothing) is passed over.
///
/// Groups are the vertices of the faces below a g, o or usemtl line; equal names are one group. The group of a polygon
/// is its first g name, else its object, else its material, which it has besides. Negative indices, line continuations
/// and faces before their vertices are read. Throws input_error with the line. Triangles are not cut here.
SurfaceMesh read_obj(const MeshSource& source, const Log& log);

}  // namespace softreel::detail
