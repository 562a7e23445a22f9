/// Lights, surroundings and materials of a shot at one frame: keys become values.
#pragma once

#include <optional>
#include <vector>

#include "render/scene/sky_model.h"
#include "tool/shot/shot.h"

namespace softreel {

struct FrameLights {
  std::vector<AreaLight> lamps;
  std::vector<SunLight> suns;  ///< that of the sky is the last one
};

/// Throws input_error where keys take a lamp to the point that it aims at.
FrameLights lights_at(const Shot& shot, double frame);

/// Without its picture, which is the file's or that of daylight_at.
Environment environment_at(const Shot& shot, double frame);

/// The sky at a frame, if the shot has one.
std::optional<Daylight> daylight_at(const Shot& shot, double frame);

Appearance appearance_at(const MaterialSettings& material, double frame);

}  // namespace softreel
