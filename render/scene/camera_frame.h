/// The camera as vectors: what the path tracer and the preview share, so that their silhouettes coincide.
#pragma once

#include "render/scene/camera.h"
#include "render/scene/pixel_window.h"

namespace softreel {

/// Orthonormal axes, the window at distance 1 and the lens; lengths in m.
struct CameraFrame {
  Vec3f position, right, up, forward;
  float half_width = 0, half_height = 0;  ///< of the window one metre ahead
  float center_x = 0, center_y = 0;       ///< of the window, along `right` and `up`; 0 for the whole picture
  float focus_distance = 0;               ///< along `forward`
  float lens_radius = 0;                  ///< 0: pinhole

  /// Point of the window one metre ahead, relative to `position`; x, y in [-1, 1], y up.
  Vec3f window_point(float x, float y) const {
    return forward + (center_x + x * half_width) * right + (center_y + y * half_height) * up;
  }
};

/// For a picture of width x height pixels, which are square. Throws input_error if the target is at the position, the
/// view is along `up`, or a length is not finite and above 0.
CameraFrame camera_frame(const Camera& camera, int width, int height);

/// The same camera, whose window shows only a part of a picture of width x height pixels, or more than it.
CameraFrame seen_through(const PixelWindow& window, CameraFrame frame, int width, int height);

}  // namespace softreel
