#include "render/preview/egl/gpu_sky.h"

#include <algorithm>
#include <utility>

namespace softreel {
namespace {

/// Means of 2 x 2 pixels; an odd last row or column is left out.
EnvironmentImage halved(const EnvironmentImage& image) {
  EnvironmentImage half{std::max(1, image.width / 2), std::max(1, image.height / 2), {}};
  half.pixels.reserve(static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height));
  const auto at = [&](int x, int y) -> const Vec3f& {
    x = std::min(x, image.width - 1);
    y = std::min(y, image.height - 1);
    return image
        .pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x)
      half.pixels.push_back(
          0.25f * (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) + at(2 * x, 2 * y + 1) + at(2 * x + 1, 2 * y + 1)));
  return half;
}

}  // namespace

void GpuSky::bind(GLuint unit, const std::shared_ptr<const EnvironmentImage>& image) {
  if (texture_ == 0) glGenTextures(1, &texture_);
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_2D, texture_);
  if (image == image_) return;
  image_ = image;
  harmonics_ = sky_harmonics(*image);
  send(*image);
}

void GpuSky::send(EnvironmentImage image) {
  constexpr float kLargestHalf = 65504;
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  while (std::max(image.width, image.height) > largest) image = halved(image);
  for (Vec3f& radiance : image.pixels) radiance = radiance.cwiseMin(kLargestHalf);
  width_ = image.width;
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB16F, image.width, image.height, 0, GL_RGB, GL_FLOAT, image.pixels.data());
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

}  // namespace softreel
