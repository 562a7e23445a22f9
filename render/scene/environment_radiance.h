/// What a ray that leaves the scene sees.
#pragma once

#include "render/scene/light.h"

namespace softreel {

/// Picture coordinates (u right, v down, in [0, 1]) of a direction: u = 0.5 is -z, u = 0.75 is +x, v = 0 is +y.
/// rotation: rad, turns the surroundings counter-clockwise seen from above.
Vec2f environment_coordinates(const Vec3f& direction, float rotation);

/// The direction of picture coordinates: the inverse.
Vec3f environment_direction(const Vec2f& coordinates, float rotation);

/// Radiance from a unit direction: the image, bilinearly interpolated, or the gradient, linear in the height of the
/// direction; times strength.
Vec3f environment_radiance(const Environment& environment, const Vec3f& direction);

}  // namespace softreel
