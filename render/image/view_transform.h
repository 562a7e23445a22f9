/// From scene-linear radiance to display values.
#pragma once

#include "core/base/srgb.h"
#include "core/base/types.h"
#include "render/image/image_io.h"

namespace softreel {

/// Scene-linear (after exposure) to display-linear in [0, 1].
Vec3f apply_view(ViewTransform view, const Vec3f& linear);

}  // namespace softreel
