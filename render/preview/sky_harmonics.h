/// The light of an environment image on matt surfaces, as few numbers.
///
/// Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment Maps, 2001.
#pragma once

#include <array>

#include "render/scene/light.h"

namespace softreel {

inline constexpr int kSkyHarmonics = 9;

/// Factors of 1, x, y, z, xy, yz, xz, 3y^2 - 1 and x^2 - z^2, of a unit normal (x, y, z).
using SkyHarmonics = std::array<Vec3f, kSkyHarmonics>;

/// Their sum is irradiance / pi of the image, at strength 1 and not rotated. Exact for an image of the same nine
/// functions; small bright places, such as a sun, leave errors of a few hundredths of their share. Linear time.
SkyHarmonics sky_harmonics(const EnvironmentImage& image);

/// The sum for one normal; it may be a little below 0.
Vec3f sky_light(const SkyHarmonics& harmonics, const Vec3f& normal);

}  // namespace softreel
