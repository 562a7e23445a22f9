/// Which lights of a scene a preview has room for.
#pragma once

#include <vector>

#include "render/scene/scene.h"

namespace softreel {

inline constexpr int kMaxPreviewLamps = 32;
inline constexpr int kMaxPreviewSuns = 8;

/// Indices in scene.area_lights and scene.suns, rising.
struct PreviewLights {
  std::vector<int> lamps, suns;
};

/// All lights; of more than there is room for, those that send most to the middle of the bodies.
PreviewLights preview_lights(const Scene& scene);

/// How many lights are not among them.
int lights_left_out(const Scene& scene);

/// What a lamp shows to a point that it faces, m^2.
float seen_area(const AreaLight& lamp);

}  // namespace softreel
