/// From scene-linear radiance to display values.
#pragma once

#include "core/base/srgb.h"
#include "core/base/types.h"
#include "render/image/image_io.h"

namespace softreel {

/// Display-linear to sRGB code value, both in [0, 1] (IEC 61966-2-1), and back.
float srgb_encode(float linear);
float srgb_decode(float encoded);

/// 255 srgb_encode(linear), rounded: the same byte without the power, some ten times as quick.
std::uint8_t srgb_byte(float linear);

/// Scene-linear (after exposure) to display-linear in [0, 1]. For Raw the code value itself: no curve comes after it.
Vec3f apply_view(ViewTransform view, const Vec3f& linear);

}  // namespace softreel
