/// Writes a surface as a binary PLY file.
#pragma once

#include <string>

#include "core/mesh/surface_mesh.h"

namespace softreel::sculpt {

/// Float x, y, z, `uchar red, green, blue` (sRGB) of a mesh with colours, and, per group, `uchar group_NAME` (1: the
/// vertex is in it); triangles as lists, with their texture coordinates if the mesh has some. Little-endian.
/// Throws work_error, naming the file, if it cannot be written.
void write_ply(const SurfaceMesh& mesh, const std::string& path);

}  // namespace softreel::sculpt
