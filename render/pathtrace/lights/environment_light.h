/// The environment as a light: an image is sampled by its brightness.
#pragma once

#include <vector>

#include "render/pathtrace/lights/rectangle_light.h"

namespace softreel {

/// A gradient is smooth, so that rays scattered by surfaces find it as well as any sampling would: only an image is
/// sampled here.
class EnvironmentLight {
 public:
  /// Keeps a reference to `environment`.
  explicit EnvironmentLight(const Environment& environment);

  bool sampled() const { return !rows_.empty(); }
  LightSample sample(const Vec2f& u) const;
  /// Density of sample() by solid angle.
  float pdf(const Vec3f& direction) const;
  Vec3f radiance(const Vec3f& direction) const;
  /// Rough irradiance on any surface.
  float importance() const { return importance_; }

 private:
  float texel_pdf(int column, int row) const;

  const Environment& environment_;
  int width_ = 0, height_ = 0;
  std::vector<float> rows_;     ///< cumulated shares of rows: height + 1, from 0 to 1
  std::vector<float> columns_;  ///< per row, cumulated shares within it: height x (width + 1)
  float importance_ = 0;
};

}  // namespace softreel
