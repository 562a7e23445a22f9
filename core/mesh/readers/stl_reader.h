/// STL, binary and text: one vertex per corner, three per triangle, in the order of the file.
#pragma once

#include "core/mesh/readers/mesh_source.h"

namespace softreel::detail {

/// A file is binary if its size is what its count of triangles asks for (84 + 50 n bytes), else text. Normals and
/// attribute bytes are passed over; a named solid of a text file becomes a group. Throws input_error.
SurfaceMesh read_stl(const MeshSource& source, const Log& log);

}  // namespace softreel::detail
