/// How much of a texture one ray stands for.
///
/// A ray carries a cone: Amanatides, Ray Tracing with Cones, 1984; Akenine-Moeller et al., Improved Shader and Texture
/// Level of Detail Using Ray Cones, 2021, whose ellipse on the surface is used here. Camera cones are a pixel wide
/// divided by the square root of the samples, as each sample stands for its share of the pixel (as pbrt scales its ray
/// differentials); a scattered ray's cone opens to the share of directions that it stands for (Suykens and Willems,
/// Path Differentials and Applications, 2001, in their simplest form).
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/types.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {

/// Diameter of the cone along a ray.
struct RayCone {
  float width = 0;   ///< m, at the ray's origin
  float spread = 0;  ///< growth, m a metre

  float width_at(float distance) const { return width + spread * distance; }

  /// After a scattering `distance` along the ray into one of the directions of density `pdf` (0: as by a flat mirror),
  /// of which `samples` are drawn.
  RayCone scattered(float distance, float pdf, float samples) const {
    // The cone of solid angle 1 / (samples pdf); not wider than half a radian to a side, as its tangent grows without
    // end and finer levels are the safe side.
    const float opening = pdf > 0 ? 2 * std::sqrt(std::min(0.25f, 1 / (kPi * samples * pdf))) : 0.0f;
    return {width_at(distance), spread + opening};
  }
};

/// Share of a pixel's width that one of `samples` stands for.
inline float cone_share(int samples) {
  return std::max(0.125f, 1 / std::sqrt(static_cast<float>(samples)));
}

}  // namespace softreel
