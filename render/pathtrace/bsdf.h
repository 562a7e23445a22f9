/// The scattering function of an Appearance: a mixture of diffuse, GGX reflection and glass.
///
/// Reflection. Coat (white-ish dielectric, weight of the base) and metal share the roughness, so one GGX lobe carries
/// the sum of their Schlick reflectances. Light that a single reflection loses (metal) or lets through (coat) returns
/// as a cosine-like lobe c (1 - E(o)) (1 - E(i)), with E the directional albedo: Kelemen and Szirmay-Kalos, A
/// Microfacet Based Coupled Specular-Matte BRDF, 2001; Kulla and Conty, Revisiting Physically Based Shading at
/// Imageworks, 2017. Both are reciprocal, and neither gains energy. Glass. Walter et al. 2007 with the true Fresnel
/// term. It carries radiance over squared index, so that a path needs no factor on its way in and out. Rough glass
/// loses what needs a second scattering at the surface.
#pragma once

#include <array>

#include "render/pathtrace/microfacet.h"
#include "render/scene/material.h"

namespace softreel {

/// Directional albedos of a GGX surface of one roughness, two numbers a cosine.
class AlbedoTable {
 public:
  /// Reflectance F0 at normal incidence gives F0 * x + y.
  static AlbedoTable of_reflection(float alpha);
  /// Shares of light that glass reflects and lets through; eta: index of the far side over that of the near side.
  static AlbedoTable of_glass(float alpha, float eta);

  /// At the cosine mu in [0, 1].
  Vec2f at(float cosine) const;
  /// Mean, weighted by 2 mu.
  Vec2f mean() const { return mean_; }
  /// share: 0 gives a, bit for bit.
  static AlbedoTable between(const AlbedoTable& a, const AlbedoTable& b, float share);

 private:
  template <typename At>
  void fill(const At& albedo_at);

  static constexpr int kIntervals = 32;
  std::array<Vec2f, kIntervals + 1> knots_;  ///< at mu = (k / kIntervals)^2: dense where E bends, at grazing angles
  Vec2f mean_ = Vec2f::Zero();
};

/// The tables of one appearance: all that is slow to prepare. They depend on roughness and index, not on colours.
struct AlbedoTables {
  AlbedoTable reflection;                   ///< filled unless the appearance is only diffuse
  AlbedoTable glass_outside, glass_inside;  ///< filled for glass

  static AlbedoTables of(const Appearance& appearance);
  /// Between those of two appearances that differ in roughness only. share: 0 gives a, bit for bit.
  static AlbedoTables between(const AlbedoTables& a, const AlbedoTables& b, float share);
};

/// f cos_i and the density of sample() for the same pair.
struct BsdfValue {
  Vec3f value = Vec3f::Zero();
  float pdf = 0;
};

struct BsdfSample {
  Vec3f direction;      ///< local
  Vec3f weight;         ///< f cos_i / pdf
  float pdf = 0;        ///< by solid angle; 0 if `mirror`
  bool wide = false;    ///< of a lobe so wide that no details show through it
  bool mirror = false;  ///< one of finitely many directions: no light sampling can find it
};

/// One prepared material. Directions are local, unit, and point away from the surface; `o` towards the viewer, on the
/// side of +z. `inside`: +z is the inside of the glass.
class Bsdf {
 public:
  explicit Bsdf(const Appearance& appearance) : Bsdf(appearance, AlbedoTables::of(appearance)) {}
  /// Quick; tables: those of an appearance that differs in colours only, or between those of two neighbours.
  Bsdf(const Appearance& appearance, const AlbedoTables& tables);

  BsdfValue evaluate(const Vec3f& o, const Vec3f& i, bool inside) const;
  /// lobe, u: numbers in [0, 1). False if the sample carries nothing.
  bool sample(const Vec3f& o, float lobe, const Vec2f& u, bool inside, BsdfSample& sample) const;

  /// Whether evaluate() can be above 0, so that sampling lights makes sense.
  bool has_smooth_part() const { return diffuse_or_metal_ || !mirror_; }
  bool transmits() const { return glass_ > 0; }
  const Vec3f& absorption() const { return absorption_; }
  const Vec3f& emission() const { return emission_; }
  /// What the albedo channel shows.
  const Vec3f& albedo() const { return albedo_; }

 private:
  /// Probabilities of sampling the lobes, as seen from one direction.
  struct Shares {
    float reflection = 0, cosine = 0, glass = 0;
  };
  Shares shares(const Vec2f& e) const;
  Vec3f reflectance(float cosine) const { return f0_ + (f90_ - f0_) * schlick_weight(cosine); }
  Vec3f cosine_lobe(float cos_o, float cos_i) const;
  void add_reflection(const Vec3f& o, const Vec3f& i, float share, BsdfValue& sum) const;
  void add_glass(const Vec3f& o, const Vec3f& i, bool inside, float share, BsdfValue& sum) const;
  bool sample_mirror_glass(const Vec3f& o, float u, float eta, BsdfSample& sample) const;
  Vec3f sample_rough_glass(const Vec3f& o, float u_side, const Vec2f& u, float eta) const;

  float alpha_;
  bool mirror_;            ///< GGX and glass are perfectly smooth
  bool lambertian_;        ///< only the diffuse lobe, without coat
  bool diffuse_or_metal_;  ///< the cosine lobe is not black
  float glass_;            ///< weight of the glass lobe
  float ior_;
  Vec3f f0_, f90_;  ///< reflectances of coat and metal, with their weights
  Vec3f diffuse_;   ///< albedo under the coat, with weight
  float coat_f0_;
  float coat_scale_ = 1;                ///< of the diffuse lobe: 1 / (1 - mean coat albedo)
  Vec3f metal_return_ = Vec3f::Zero();  ///< of multiple scattering among facets, with weight
  Vec3f absorption_, emission_, albedo_;
  AlbedoTable ggx_albedo_, glass_outside_, glass_inside_;
};

}  // namespace softreel
