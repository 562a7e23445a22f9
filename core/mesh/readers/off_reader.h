/// Object File Format (Geomview), text form: vertices and polygons in the order of the file.
#pragma once

#include "core/mesh/readers/mesh_source.h"

namespace softreel::detail {

/// Reads OFF and its variants COFF, NOFF, CNOFF and STOFF: one vertex or face a line, comments after '#', colours and
/// normals passed over, the texture coordinates of an ST file kept. The keyword and the number of edges may be absent.
/// Throws input_error with the line. Triangles are not cut here.
SurfaceMesh read_off(const MeshSource& source, const Log& log);

}  // namespace softreel::detail
