#include "tool/export/export_colors.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/srgb.h"

namespace softreel {
namespace {

/// The byte that is nearest, as readers take it.
float as_byte(float displayed) {
  return static_cast<float>(static_cast<double>(std::lround(255 * displayed)) / 255);
}

float displayed_value(float linear) {
  const float exact = srgb_encode(linear), byte = as_byte(exact);
  return srgb_decode(byte) == linear ? byte : exact;
}

}  // namespace

bool shows_vertex_colors(const ExportBody& body) {
  return body.textures.vertex_colors && !body.mesh->colors.empty();
}

std::vector<Vec3f> linear_colors(const SurfaceMesh& mesh) {
  CHECK((mesh.colors.empty() || mesh.colors.size() == mesh.positions.size()));
  std::vector<Vec3f> colors = mesh.colors;
  for (Vec3f& color : colors)
    for (int k = 0; k < 3; ++k) color[k] = color[k] > 0 ? std::min(color[k], 1.0f) : 0.0f;
  return colors;
}

std::vector<Vec3f> displayed_colors(const SurfaceMesh& mesh) {
  std::vector<Vec3f> colors = linear_colors(mesh);
  for (Vec3f& color : colors)
    for (int k = 0; k < 3; ++k) color[k] = displayed_value(color[k]);
  return colors;
}

bool are_bytes(std::span<const Vec3f> displayed) {
  return std::all_of(displayed.begin(), displayed.end(), [](const Vec3f& color) {
    return as_byte(color.x()) == color.x() && as_byte(color.y()) == color.y() && as_byte(color.z()) == color.z();
  });
}

}  // namespace softreel
