/// Surface meshes in the formats of assimp, and its entry as a part.
#pragma once

#include <string>

#include "core/base/log.h"
#include "core/mesh/surface_mesh.h"

namespace softreel::detail {

/// Polygons of all meshes of a file, put together in the order of its nodes with their transforms applied; not cut into
/// triangles. Bones and shape keys are left out with a warning. Throws input_error if assimp cannot read the file.
extern "C" [[gnu::visibility("default")]] SurfaceMesh softreel_read_with_assimp(const std::string& path,
                                                                                const Log& log);

}  // namespace softreel::detail
