/// Binary PLY of one frame: the imported mesh with other positions, in the order of its file, with its groups.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/surface_mesh.h"
#include "tool/export/exporter.h"

namespace softreel {

/// The bytes of a binary little-endian .ply file. mesh: as imported; positions: one per vertex; normals: the same, or
/// none.
///
/// vertex: double x, y, z (double, so that nothing is rounded); double nx, ny, nz with normals; double s, t where each
/// vertex has one texture coordinate; red, green, blue on the sRGB curve where the mesh has colours, uchar where these
/// say them without loss, else float; uchar group_NAME per vertex group (names as in core/mesh/readers/ply_reader.h).
/// face: vertex_indices; where texture coordinates differ between the corners of a vertex, the list texcoord of u and v
/// per corner instead of s and t.
std::vector<std::uint8_t> encode_ply(const SurfaceMesh& mesh, std::span<const Vec3> positions,
                                     std::span<const Vec3> normals = {});

ExportFormat ply_format();

}  // namespace softreel
