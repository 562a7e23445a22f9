/// How a surface scatters light.
#pragma once

#include <optional>

#include "core/base/types.h"

namespace softreel {

/// A principled material. From the top: sheen (fibres), coat (clear varnish), and a base of four lobes: diffuse or
/// subsurface, GGX dielectric over it, GGX metal, rough or smooth glass.
///
/// metallic and transmission mix the base's lobes: metal with weight metallic, glass with (1 - metallic) transmission,
/// the rest is diffuse under dielectric, of which the share `subsurface` scatters inside the body. Each lobe conserves
/// energy, and white without absorption returns all light.
struct Appearance {
  Vec3f base_color = Vec3f(0.8f, 0.8f, 0.8f);  ///< linear albedo of the diffuse lobe, colour of the metal
  float roughness = 0.5f;                      ///< perceptual: GGX alpha = roughness^2
  float metallic = 0;
  std::optional<Vec3f> metal_color;  ///< of the metal at normal incidence, if it is not base_color
  float specular = 0.5f;             ///< strength of the dielectric: reflectance at normal incidence 0.08 * specular
  float transmission = 0;
  float ior = 1.5f;                  ///< of the glass
  Vec3f absorption = Vec3f::Zero();  ///< 1/m, inside glass (Beer's law)
  Vec3f emission = Vec3f::Zero();    ///< radiance, seen from outside

  float coat = 0;            ///< weight of the varnish
  float coat_roughness = 0;  ///< perceptual
  float coat_ior = 1.5f;
  Vec3f coat_color = Vec3f::Ones();  ///< of white seen straight through the varnish, above 0

  float sheen = 0;               ///< weight of the fibres
  float sheen_roughness = 0.5f;  ///< at least Sheen::kLeastRoughness
  Vec3f sheen_color = Vec3f::Ones();

  float subsurface = 0;  ///< share of the diffuse lobe; its albedo is base_color
  /// m, how far light spreads before it comes out (scattering radius of Chiang et al. 2016), times subsurface_scale.
  Vec3f subsurface_radius = Vec3f(0.02f, 0.01f, 0.006f);
  float subsurface_scale = 1;
  float subsurface_anisotropy = 0;  ///< mean cosine of a scattering inside, -1 to 1
};

}  // namespace softreel
