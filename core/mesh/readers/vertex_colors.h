/// Colours of vertices: from what a file says to linear RGB.
#pragma once

#include <vector>

#include "core/base/srgb.h"
#include "core/base/types.h"

namespace softreel::detail {

/// PLY and OBJ say colours as a screen shows them, in [0, 1] on the sRGB curve (MeshLab, Blender and scanners write
/// them so; neither format says anything about it). Numbers outside of that range stay outside.
inline Vec3f displayed_color(double red, double green, double blue) {
  return {srgb_decode(static_cast<float>(red)), srgb_decode(static_cast<float>(green)),
          srgb_decode(static_cast<float>(blue))};
}

/// Vertices that came without a colour before, or come without one after, a vertex that has one are white.
inline void pad_colors(std::vector<Vec3f>& colors, std::size_t vertices) {
  colors.resize(vertices, Vec3f::Ones());
}

}  // namespace softreel::detail
