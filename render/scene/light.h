/// Lights, environment and ground of a picture.
#pragma once

#include <memory>
#include <vector>

#include "core/base/types.h"

namespace softreel {

enum class LampShape {
  Rectangle,
  Disk,   ///< or an ellipse
  Sphere  ///< of radius |u|
};

/// A lamp. Rectangles and disks emit from the side their `normal = u x v` points to, spheres outwards. Like studio
/// lamps in other renderers it adds its light without hiding what is behind it.
struct AreaLight {
  Vec3f center = Vec3f(0, 4, 0);
  Vec3f u = Vec3f(0.5f, 0, 0), v = Vec3f(0, 0, 0.5f);  ///< half edges or half axes, perpendicular, m
  Vec3f radiance = Vec3f::Ones();                      ///< W / (m^2 sr)
  bool visible = true;                                 ///< to camera rays
  LampShape shape = LampShape::Rectangle;
};

/// A distant disk.
struct SunLight {
  Vec3f direction = Vec3f(0, -1, 0);  ///< the way its light travels, unit
  Vec3f irradiance = Vec3f::Ones();   ///< W/m^2 on a surface that faces it
  float angular_diameter = 0.0093f;   ///< rad; the sun's 0.53 degrees
};

/// Latitude-longitude picture of the surroundings, rows from straight up to straight down.
struct EnvironmentImage {
  int width = 0, height = 0;
  std::vector<Vec3f> pixels;  ///< height x width, linear radiance
};

/// What rays that leave the scene see: an image if there is one, else a vertical gradient.
struct Environment {
  Vec3f zenith = Vec3f(0.5f, 0.5f, 0.5f);  ///< straight up
  Vec3f horizon = Vec3f(0.5f, 0.5f, 0.5f);
  Vec3f nadir = Vec3f(0.2f, 0.2f, 0.2f);  ///< straight down
  std::shared_ptr<const EnvironmentImage> image;
  float strength = 1;
  float rotation = 0;  ///< rad about the vertical, image only
};

}  // namespace softreel
