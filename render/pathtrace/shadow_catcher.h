/// A ground that is seen only by the shadow on it: how much of the direct light on one of its points the bodies take.
#pragma once

#include "render/pathtrace/path_integrator.h"

namespace softreel {

/// Estimates of the direct light, as luminance, that a matt point of the ground sends back.
struct CaughtLight {
  float unshadowed = 0;  ///< with nothing but the ground in the scene
  float shadowed = 0;    ///< with the bodies in the way; from the same rays
};

/// Light on `point` of the ground, which is the last mesh of the picture, by one sample of every light and, of a sky
/// that is a gradient, one of the directions around it. The ground itself is never in the way, so that the two are
/// equal bits where no body is.
CaughtLight caught_light(const Picture& picture, const SurfacePoint& point, float time, const SampleBlock& numbers);

}  // namespace softreel
