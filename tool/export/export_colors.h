/// The colours of a mesh's vertices on their way out: within what formats can say, linear or as a screen shows them.
#pragma once

#include <span>
#include <vector>

#include "tool/export/exporter.h"

namespace softreel {

/// Whether the body's look has the mesh's colours for its base colour.
bool shows_vertex_colors(const ExportBody& body);

/// Of each vertex, linear, held in [0, 1] (what is no number is 0); empty if the mesh has none.
std::vector<Vec3f> linear_colors(const SurfaceMesh& mesh);
/// The same on the sRGB curve, as OBJ and PLY say them: what a file had as a byte is that byte's 255th again.
std::vector<Vec3f> displayed_colors(const SurfaceMesh& mesh);
/// Whether bytes say such colours without loss.
bool are_bytes(std::span<const Vec3f> displayed);

}  // namespace softreel
