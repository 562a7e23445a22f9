/// How a surface scatters light.
#pragma once

#include <optional>

#include "core/base/types.h"

namespace softreel {

/// A principled material of four lobes: diffuse, GGX dielectric coat over it, GGX metal, rough or smooth glass.
///
/// metallic and transmission mix the lobes: metal with weight metallic, glass with (1 - metallic) transmission, diffuse
/// under dielectric with the rest. Each lobe conserves energy.
struct Appearance {
  Vec3f base_color = Vec3f(0.8f, 0.8f, 0.8f);  ///< linear albedo of the diffuse lobe, colour of the metal
  float roughness = 0.5f;                      ///< perceptual: GGX alpha = roughness^2
  float metallic = 0;
  std::optional<Vec3f> metal_color;  ///< of the metal at normal incidence, if it is not base_color
  float specular = 0.5f;  ///< strength of the dielectric coat: reflectance at normal incidence 0.08 * specular
  float transmission = 0;
  float ior = 1.5f;                  ///< of the glass
  Vec3f absorption = Vec3f::Zero();  ///< 1/m, inside glass (Beer's law)
  Vec3f emission = Vec3f::Zero();    ///< radiance
};

}  // namespace softreel
