/// Where a preview's picture begins.
#pragma once

namespace softreel {

/// Least w of clip coordinates, m: what is nearer is behind the camera.
inline constexpr float kNearest = 1e-4f;

}  // namespace softreel
