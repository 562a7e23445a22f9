/// The colours of values that are shown on a surface.
#pragma once

#include <vector>

#include "core/base/types.h"
#include "render/scene/scene.h"

namespace softreel {

/// Viridis (S. van der Walt and N. Smith, matplotlib, 2015), in which equal steps look equally large, in colour and in
/// grey; the polynomials of sixth degree that M. Zucker fitted to it (2019, public domain), within 0.015. x: 0 to 1,
/// held beyond it. sRGB code values in [0, 1], as a picture's legend needs them.
Vec3f heat_code(float x);

/// The same as linear albedo.
Vec3f heat_color(float x);

/// Linear base colour of each vertex of a mesh as its heat or its colours say; empty for a mesh that has neither. What
/// a renderer needs that cannot do it at each pixel.
std::vector<Vec3f> vertex_base_colors(const MotionMesh& mesh);

}  // namespace softreel
