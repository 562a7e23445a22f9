/// Wavefront OBJ of one frame: the imported mesh with other positions, in the order of its file.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/surface_mesh.h"
#include "tool/export/exporter.h"

namespace softreel {

/// The bytes of an .obj file. mesh: as imported; positions: one per vertex of the file; normals: the same, or none.
///
/// All vertices (used or not), texture coordinates, polygons and the group of each polygon are written; numbers are the
/// shortest decimals that read back as the same doubles. Vertex groups that no polygon names cannot be said in OBJ: PLY
/// keeps them. Where the mesh has colours, r, g and b stand behind each vertex's x, y and z, in [0, 1] on the sRGB
/// curve: a widespread extension.
std::vector<std::uint8_t> encode_obj(const SurfaceMesh& mesh, std::span<const Vec3> positions,
                                     std::span<const Vec3> normals = {});

ExportFormat obj_format();

}  // namespace softreel
