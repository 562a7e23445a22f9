/// Pictures on disk: multichannel float EXR, display PNG; decoding of environment images.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "render/image/image.h"
#include "render/scene/light.h"

namespace softreel {

/// How scene-linear radiance becomes a display picture.
enum class ViewTransform {
  Standard,  ///< sRGB curve, clipped
  Filmic,    ///< soft shoulder that keeps bright colours from clipping, then the sRGB curve
  AcesFit,   ///< S. Hill's fit of the ACES 1.0 reference rendering and sRGB output transforms, then the sRGB curve
  Raw        ///< the linear values themselves, clipped: for data, and to see what is there
};

/// 8-bit display pixels, height x width x 3.
struct DisplayImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  std::vector<std::uint8_t> alpha = {};  ///< height x width, not premultiplied; empty: opaque
  bool linear = false;                   ///< the pixels are linear values; false: sRGB code values
};

/// The picture on middle grey where it is not opaque, so that shadows caught in the alpha are seen and compared.
DisplayImage over_grey(DisplayImage image);

/// Channels R, G, B times 2^exposure, through the view transform, rounded to 8 bits (no dithering: equal frames are
/// equal bits). A channel A becomes the alpha; the colours are divided by it first. What is no number becomes 0, an
/// alpha too. threads: as of encode_png.
DisplayImage to_display(const Image& image, ViewTransform view, float exposure, const Threads* threads = nullptr);

/// Bytes of a PNG / EXR file; the caller writes them, so that all files of a run are written in one way. The bytes
/// depend on the pixels only (no dates, no host names, no threads). threads: that share the work; null: the calling
/// one.
std::vector<std::uint8_t> encode_png(const DisplayImage& image, const Threads* threads = nullptr);
std::vector<std::uint8_t> encode_exr(const Image& image);

/// Reads back what the encoders wrote, and any RGB(A) PNG / scan-line EXR. Throws input_error naming the file.
DisplayImage read_png(const std::string& path);
Image read_exr(const std::string& path);

/// The picture of a texture as its file has it.
struct TexturePicture {
  int width = 0, height = 0;
  std::vector<Vec3f> pixels;  ///< height x width; a grey picture has three equal values
  int bits = 8;               ///< of a value; 8 and 16: code values in [0, 1]; 32: the file's own numbers
};

/// From PNG (8 and 16 bits, transparency left out), JPEG, EXR (R, G, B or Y) or HDR. Throws input_error.
TexturePicture read_texture_picture(const std::string& path);

/// Width and height of a texture or an environment, by its file's header alone. Throws input_error.
std::pair<int, int> picture_size(const std::string& path);

/// An environment from EXR, HDR, PNG or JPEG (the last two through the inverse sRGB curve). Throws input_error.
EnvironmentImage read_environment(const std::string& path);

}  // namespace softreel
