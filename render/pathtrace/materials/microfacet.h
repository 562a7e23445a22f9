/// GGX microfacets and Fresnel reflectances in the local frame of a surface (normal = z).
///
/// Walter et al., Microfacet Models for Refraction, 2007; Heitz, Understanding the Masking-Shadowing Function, 2014;
/// Heitz, Sampling the GGX Distribution of Visible Normals, 2018.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/types.h"

namespace softreel {

/// Below this alpha a surface is treated as perfectly smooth: its highlight is narrower than float directions resolve.
inline constexpr float kSmoothAlpha = 1e-3f;

/// Lobes of this alpha (roughness 0.32) and more are wide: no details show in them.
inline constexpr float kWideAlpha = 0.1f;

/// Density of facet normals, D(h).
inline float ggx_distribution(float cos_h, float alpha) {
  const float a2 = alpha * alpha;
  const float sin2 = std::max(0.0f, 1 - cos_h * cos_h);
  const float t = sin2 + a2 * cos_h * cos_h;  // 1 + (a2 - 1) cos^2, without cancellation
  return a2 / (std::numbers::pi_v<float> * t * t);
}

/// Smith's Lambda for a direction with this cosine.
inline float ggx_lambda(float cosine, float alpha) {
  const float c2 = cosine * cosine;
  const float tan2 = std::max(0.0f, 1 - c2) / c2;
  return 0.5f * (std::sqrt(1 + alpha * alpha * tan2) - 1);
}

/// Share of facets seen from one direction, G1.
inline float ggx_masking(float cosine, float alpha) {
  return 1 / (1 + ggx_lambda(cosine, alpha));
}

/// Share seen from both sides of a reflection, height-correlated G2.
inline float ggx_shadowing(float cos_o, float cos_i, float alpha) {
  return 1 / (1 + ggx_lambda(cos_o, alpha) + ggx_lambda(cos_i, alpha));
}

/// Sampling weight G2 / G1 of a direction with cosine `cos_i`, which may be on either side.
inline float shadowing_weight(const Vec3f& o, float cos_i, float alpha) {
  return ggx_shadowing(o.z(), std::abs(cos_i), alpha) / ggx_masking(o.z(), alpha);
}

/// Density with which sample_visible_normal finds h as seen from o: D_o(h) = G1(o) max(0, o.h) D(h) / cos_o.
inline float visible_normal_density(const Vec3f& o, const Vec3f& h, float alpha) {
  return ggx_masking(o.z(), alpha) * std::max(0.0f, o.dot(h)) * ggx_distribution(h.z(), alpha) / o.z();
}

/// The facet normal seen from o (o.z > 0) at a point of the unit disk: even points give visible normals.
Vec3f visible_normal(const Vec3f& o, float alpha, const Vec2f& disk);

/// A facet normal seen from o (o.z > 0), with that density.
Vec3f sample_visible_normal(const Vec3f& o, float alpha, const Vec2f& u);

/// (1 - c)^5, the angle term of Schlick's reflectance F0 + (1 - F0) (1 - c)^5.
inline float schlick_weight(float cosine) {
  const float m = std::clamp(1 - cosine, 0.0f, 1.0f);
  const float m2 = m * m;
  return m2 * m2 * m;
}

/// Unpolarised Fresnel reflectance. cosine: of the incident direction, above 0; eta: index of the far side over that of
/// the near side. 1 for total internal reflection.
float fresnel_dielectric(float cosine, float eta);

/// Refracts `o` (pointing away from the surface) at the facet `h` (o.h > 0). False for total internal reflection.
bool refract(const Vec3f& o, const Vec3f& h, float eta, Vec3f& refracted);

}  // namespace softreel
