/// The colours of cut tetrahedra in pictures: linear albedo.
#pragma once

#include <array>

#include "core/base/types.h"

namespace softreel {

constexpr float kCutLineWidth = 1.25f;  ///< pixels of a picture that is 1600 wide

/// Of the boundary of the whole mesh, and of the lines on it and on what a cut lays bare.
Vec3f outer_color();
Vec3f outer_line_color();
Vec3f cut_line_color();

constexpr std::size_t kAngleTints = 13;  ///< 0, 5, ... 60 degrees

/// From red (0 degrees) to sand (60).
Vec3f angle_tint_color(std::size_t tint);

/// The nearest tint to an element's smallest dihedral angle; one without volume, or inside out, has the worst.
std::size_t angle_tint(const std::array<Vec3, 4>& corners);

}  // namespace softreel
