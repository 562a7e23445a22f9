/// A pinhole or thin-lens camera.
#pragma once

#include "core/base/types.h"

namespace softreel {

/// Looks from `position` to `target`; lengths in m, right-handed, `up` need not be orthogonal.
struct Camera {
  Vec3f position = Vec3f(0, 1, 4);
  Vec3f target = Vec3f(0, 0.5f, 0);
  Vec3f up = Vec3f(0, 1, 0);
  float focal_length_mm = 50;
  float sensor_width_mm = 36;  ///< across the image
  float f_number = 0;          ///< aperture diameter = focal length / f_number; 0: pinhole, everything sharp
  float focus_distance = 0;    ///< m along the view axis; 0: at the target

  friend bool operator==(const Camera&, const Camera&) = default;
};

/// How the shutter lets light in over the time it is open: it opens evenly during the first part of it and closes
/// evenly during the last. 0 and 0: a box, all times alike; 0.5 and 0.5: a triangle.
struct ShutterCurve {
  float opening = 0, closing = 0;  ///< shares of the time, 0 or more, at most 1 together
};

}  // namespace softreel
