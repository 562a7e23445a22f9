/// Writing of PNG files (ISO/IEC 15948) in strips that threads compress side by side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"

namespace softreel {

/// What the values of a file mean, which it tells its readers.
enum class PngValues : std::uint8_t { Srgb, Linear };

/// A file of 8 bits a value: 3 components (RGB) or 4 (RGBA, not premultiplied). pixels: height x width x
/// components. The bytes depend on the pixels only, not on the threads; null: the calling one.
/// Throws work_error where memory is short.
std::vector<std::uint8_t> png_file(int width, int height, int components, std::span<const std::uint8_t> pixels,
                                   PngValues values, const Threads* threads);

/// Whether the beginning of a file, 64 bytes or more, is that of a PNG which says so: a gAMA chunk of 1 behind the
/// header.
bool is_linear_png(std::span<const std::uint8_t> beginning);

}  // namespace softreel
