/// Surface meshes from files of any format that assimp reads, and of the text formats in the file's own order.
#pragma once

#include <string>

#include "core/base/log.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Reads a mesh file and cuts its polygons into triangles; vertex v of the result is vertex v of the file (design 4.7).
///
/// OBJ, OFF, PLY and STL have readers of their own (core/mesh/readers), because assimp loses their vertex order. Other
/// formats (glTF, FBX, Collada, 3DS, ...) come through assimp, whose order there is the file's: meshes are put together
/// in the order of the nodes, with the nodes' transforms applied; nodes, meshes and materials become groups.
/// Nothing is merged, repaired or scaled. Faces with vertices that are not finite keep their polygon but get no
/// triangles; that and faces of fewer than 3 corners are warnings. A corner without texture coordinate in a file that
/// has some gets index -1.
/// Throws input_error for a file that is missing, no regular file, empty, cut off, garbage, or without a face.
SurfaceMesh import_mesh(const std::string& path, const Log& log);

}  // namespace softreel
