/// What formats make of a look: which pictures they can hold, and what of it they cannot say.
#pragma once

#include <string>

#include "tool/shot/shot.h"

namespace softreel {

enum class PictureKind {
  None,  ///< no path
  Png,
  Jpeg,
  Other  ///< EXR, HDR
};

/// By the first bytes of the file, whatever its name. Throws input_error if it cannot be read.
PictureKind picture_kind(const std::string& path);

/// Reflectance at normal incidence of a dielectric in air, and back.
double reflectance_of(double ior);
double ior_of(double reflectance);
/// Of the dielectric and the glass of a look together, for formats that have one number for both.
double dielectric_reflectance(const Appearance& look);

/// One line that says what `format` leaves out of a material; empty if it is all there.
std::string lost_look(const std::string& format, const std::string& name, const MaterialSettings& material);

}  // namespace softreel
