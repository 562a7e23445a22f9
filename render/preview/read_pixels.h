/// Display pictures of pixels as OpenGL gives them: four bytes each, the lowest row first.
#pragma once

#include <cstdint>
#include <vector>

#include "render/image/image_io.h"

namespace softreel {

/// Without the fourth bytes.
DisplayImage opaque_picture(const std::vector<std::uint8_t>& pixels, int width, int height);

/// The fourth bytes are the alpha, which the colours are multiplied with; those of the picture are not.
DisplayImage transparent_picture(const std::vector<std::uint8_t>& pixels, int width, int height);

}  // namespace softreel
