/// Formats whose file holds one sample of one body: the bytes of a mesh with other positions, written at once.
#pragma once

#include <functional>

#include "tool/export/exporter.h"

namespace softreel {

/// The bytes of a file. mesh: as imported; positions: one per vertex of the file; normals: the same, or none.
using EncodeSurface = std::function<std::vector<std::uint8_t>(const SurfaceMesh& mesh, std::span<const Vec3> positions,
                                                              std::span<const Vec3> normals)>;

/// ExportFormat::make of such a format.
std::function<std::unique_ptr<ExportWriter>(ExportTarget)> whole_file_writer(EncodeSurface encode);

}  // namespace softreel
