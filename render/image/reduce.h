/// Smaller display pictures.
#pragma once

#include "render/image/image_io.h"

namespace softreel {

/// The picture at `width` pixels, or itself if it is not wider; the height follows, at least 1. Each pixel is the mean
/// of the light of what it covers (averaged before the sRGB curve).
DisplayImage reduced(const DisplayImage& image, int width);

}  // namespace softreel
