/// Light from fine fibres that stand off a surface, such as velvet or the down of a peach.
///
/// Estevez and Kulla, Production Friendly Microfacet Sheen BRDF, 2017: the "Charlie" distribution of normals with its
/// fitted shadowing. The paper's softened terminator is left out: it is not reciprocal.
#pragma once

#include "render/pathtrace/materials/albedo_table.h"

namespace softreel {

/// The reflectance of white fibres.
class Sheen {
 public:
  /// roughness: of the fibres' directions, kLeastRoughness to 1.
  explicit Sheen(float roughness);

  /// f cos_i, for o and i on the side of +z; f is reciprocal.
  float value(const Vec3f& o, const Vec3f& i) const;
  /// Share of light from a direction that comes back, below 1.
  float albedo(float cosine) const { return albedo_.at(cosine).x(); }

  /// For finer fibres the fitted shadowing falls short: at 0.06 more light returns at grazing angles than arrives.
  static constexpr double kLeastRoughness = 0.1;

 private:
  /// The paper's Lambda and the curve L that it is made of.
  float lambda(float cosine) const;
  float curve(float x) const;

  float exponent_;                  ///< 1 / roughness
  float a_, b_, c_, d_, e_, half_;  ///< coefficients of L, and L(1/2)
  AlbedoTable albedo_;
};

}  // namespace softreel
