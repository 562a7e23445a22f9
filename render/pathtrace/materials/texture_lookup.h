/// Filtered values of textures.
#pragma once

#include <array>

#include "render/pathtrace/rays/surface_point.h"
#include "render/scene/texture.h"

namespace softreel {

/// An ellipse in texture coordinates, v upward.
struct TextureFootprint {
  Vec2f center = Vec2f::Zero();
  Vec2f a = Vec2f::Zero(), b = Vec2f::Zero();  ///< half axes
};

/// How texture coordinates change over a triangle in space: gradients, 1/m. Zero where the triangle has no area.
struct TextureGradients {
  Vec3f du = Vec3f::Zero(), dv = Vec3f::Zero();

  TextureGradients() = default;
  TextureGradients(const Corners& positions, const std::array<Vec2f, 3>& coordinates);
  Vec2f along(const Vec3f& step) const { return {step.dot(du), step.dot(dv)}; }
};

/// The ellipse in which a cone around a ray meets a triangle's plane, in texture coordinates. normal: of the triangle,
/// unit, towards the ray's origin; width: of the cone there, m. Akenine-Moeller et al. 2021, section 5.
TextureFootprint cone_footprint(const TextureGradients& gradients, const Vec2f& center, const Vec3f& direction,
                                const Vec3f& normal, float width);

/// Weighted mean of the texels under a footprint: up to 16 trilinear probes along its longer axis, each as wide as its
/// shorter axis (after McCormack et al., Feline: Fast Elliptical Lines for Anisotropic Texture Mapping, 1999, without
/// weights). Where all texels are equal, exactly their value. A footprint without extent: bilinear in the picture.
float look_up(const DataTexture& texture, TextureWrap wrap, const TextureFootprint& footprint);
Vec3f look_up(const ColorTexture& texture, TextureWrap wrap, const TextureFootprint& footprint);

/// The slope of heights in u and v (per unit of texture coordinate): central differences over the footprint, or over a
/// texel of the picture where that is larger. Blinn, Simulation of Wrinkled Surfaces, 1978.
Vec2f look_up_slope(const DataTexture& texture, TextureWrap wrap, const TextureFootprint& footprint);

}  // namespace softreel
