/// Textures from files: decoded for their use, with all their halvings.
#pragma once

#include <string>

#include "render/scene/texture.h"

namespace softreel {

/// The pyramid over a picture of width x height texels, row 0 on top. Each level has half the texels of the one before
/// (rounded down, at least 1) along either side, each the mean of the area that it covers, whatever the sizes: weights
/// as in Young, Non-Power-of-Two Mipmapping, 2007. So every level has the picture's mean, and equal texels stay equal
/// bit for bit.
ColorTexture make_pyramid(int width, int height, std::vector<Vec3f> texels);
DataTexture make_pyramid(int width, int height, std::vector<float> texels);

/// Albedos: PNG and JPEG through the inverse sRGB curve, EXR and HDR as they are. Throws input_error for a file that
/// cannot be read, or with a value outside of 0 to 1.
ColorTexture read_color_texture(const std::string& path);

/// Numbers as they are stored, of the green channel (which has the roughness in glTF's packing). Throws input_error for
/// a file that cannot be read; for a value outside of 0 to 1 if `is_share`; for one that is not finite.
DataTexture read_data_texture(const std::string& path, bool is_share);

/// Normals in tangent space, green upward: from [0, 1] to [-1, 1], so that the middle code value (128 of 255) is 0.
ColorTexture read_normal_texture(const std::string& path);

}  // namespace softreel
