/// The camera as vectors: what the path tracer and the preview share, so that their silhouettes coincide.
#pragma once

#include "render/scene/camera.h"

namespace softreel {

/// Orthonormal axes, the window at distance 1 and the lens; lengths in m.
struct CameraFrame {
  Vec3f position, right, up, forward;
  float half_width = 0, half_height = 0;  ///< of the window one metre ahead
  float focus_distance = 0;               ///< along `forward`
  float lens_radius = 0;                  ///< 0: pinhole

  /// Point of the window one metre ahead, relative to `position`; x, y in [-1, 1], y up.
  Vec3f window_point(float x, float y) const { return forward + (x * half_width) * right + (y * half_height) * up; }
};

/// For a picture of width x height pixels, which are square. Throws input_error if the target is at the position, the
/// view is along `up`, or a length is not finite and above 0.
CameraFrame camera_frame(const Camera& camera, int width, int height);

}  // namespace softreel
