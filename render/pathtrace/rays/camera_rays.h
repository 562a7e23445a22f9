/// Rays from the camera through the pixels of a picture: lens, shutter, and a camera that moves while it is open.
#pragma once

#include <vector>

#include "render/pathtrace/rays/ray_scene.h"
#include "render/pathtrace/rays/sampler.h"
#include "render/scene/camera_frame.h"

namespace softreel {

/// The time in [0, 1] up to which a shutter has let in the share u of its light: the inverse of the integral of the
/// trapezium that is its curve.
float shutter_time(const ShutterCurve& curve, float u);

class CameraRays {
 public:
  /// Of a picture of width x height pixels. Throws input_error for a camera that sees nothing.
  CameraRays(const Scene& scene, int width, int height);

  /// Through pixel (x, y), which may lie outside the picture. numbers: 0, 1 place in the pixel, 2, 3 on the lens, 4
  /// time.
  Ray ray(int x, int y, const SampleBlock& numbers) const;

 private:
  CameraFrame frame_at(float time) const;
  void aim(const CameraFrame& camera, float across, float up, const SampleBlock& numbers, Ray& ray) const;

  int width_, height_;
  ShutterCurve shutter_;
  std::vector<CameraFrame> frames_;  ///< at equally spaced times of the shutter; one if the camera stands still
};

}  // namespace softreel
