/// Writing of PNG files (ISO/IEC 15948) in strips that threads compress side by side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"

namespace softreel {

/// A file of 8 bits a value: 3 components (RGB) or 4 (RGBA, not premultiplied), sRGB. pixels: height x width x
/// components. The bytes depend on the pixels only, not on the threads; null: the calling one.
/// Throws work_error where memory is short.
std::vector<std::uint8_t> png_file(int width, int height, int components, std::span<const std::uint8_t> pixels,
                                   const Threads* threads);

}  // namespace softreel
