/// Scene-linear colour in half precision, uncompressed: a traced picture kept for developing it again, quick to write
/// and to read.
#pragma once

#include <cstdint>
#include <vector>

#include "render/image/image.h"

namespace softreel {

/// Channels R, G and B, rounded to the nearest half; 6 bytes a pixel and a short header. Radiance beyond the range of
/// half is held at its largest finite value, where every view transform is white.
std::vector<std::uint8_t> encode_half(const Image& image);

/// The picture that encode_half wrote. Throws work_error for anything else.
Image decode_half(const std::vector<std::uint8_t>& bytes);

}  // namespace softreel
