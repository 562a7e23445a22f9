/// The image of the surroundings in OpenGL. Part of the EGL back end, which alone may include it.
#pragma once

#include <memory>

#include <epoxy/gl.h>

#include "render/preview/sky_harmonics.h"
#include "render/scene/light.h"

namespace softreel {

/// The image of the last scene: one that is keyed may be another in each frame.
class GpuSky {
 public:
  GpuSky() = default;
  ~GpuSky() { glDeleteTextures(1, &texture_); }
  GpuSky(const GpuSky&) = delete;
  GpuSky& operator=(const GpuSky&) = delete;

  /// Binds an image, with its halvings, to a unit; sends it if it is not the last one. Half floats: radiance ends at
  /// 65504. An image larger than OpenGL takes is halved first.
  void bind(GLuint unit, const std::shared_ptr<const EnvironmentImage>& image);

  const SkyHarmonics& harmonics() const { return harmonics_; }
  int width() const { return width_; }  ///< texels

 private:
  void send(EnvironmentImage image);

  std::shared_ptr<const EnvironmentImage> image_;
  SkyHarmonics harmonics_{};
  GLuint texture_ = 0;
  int width_ = 0;
};

}  // namespace softreel
