/// The scattering function of an Appearance: diffuse, GGX reflection and glass, under coat and sheen.
///
/// Reflection. Dielectric (white-ish, weight of the base) and metal share the roughness, so one GGX lobe carries
/// the sum of their Schlick reflectances. Light that a single reflection loses (metal) or lets through (dielectric)
/// returns as a cosine-like lobe c (1 - E(o)) (1 - E(i)), with E the directional albedo of all that is above: Kelemen
/// and Szirmay-Kalos, A Microfacet Based Coupled Specular-Matte BRDF, 2001; Kulla and Conty, Revisiting Physically
/// Based Shading at Imageworks, 2017. Both are reciprocal, and neither gains energy. Glass. Walter et al. 2007 with the
/// true Fresnel term. It carries radiance over squared index, so that a path needs no factor on its way in and out.
/// What rough glass loses for want of a second scattering is given back in proportion, by its albedo seen from `o`
/// (Turquin, Practical multiple scattering compensation for microfacet models, 2019), which is not reciprocal.
/// Coat and sheen: top_layers.h; they lie on both sides.
#pragma once

#include <memory>

#include "render/pathtrace/materials/albedo_table.h"
#include "render/pathtrace/materials/microfacet.h"
#include "render/pathtrace/materials/scattering.h"
#include "render/pathtrace/materials/top_layers.h"
#include "render/pathtrace/rays/sampling.h"
#include "render/scene/material.h"

namespace softreel {

/// The inside of a body that scatters light, as an artist gives it.
struct Subsurface {
  Vec3f color = Vec3f::Zero();   ///< diffuse albedo
  Vec3f radius = Vec3f::Zero();  ///< m, scattering radius
  float anisotropy = 0;          ///< mean cosine of a scattering
};

/// What of a material is slow to prepare. It depends on roughness, index and layers, not on the base's colour.
struct AlbedoTables {
  AlbedoTable reflection;                   ///< filled unless the appearance is only diffuse: has_reflection
  AlbedoTable glass_outside, glass_inside;  ///< filled for glass
  std::shared_ptr<const TopLayers> top;     ///< null: none

  static AlbedoTables of(const Appearance& appearance) { return of(appearance, TopLayers::make(appearance)); }
  /// top: as TopLayers::make(appearance) makes them, which is slow and the same for every roughness of the base.
  static AlbedoTables of(const Appearance& appearance, std::shared_ptr<const TopLayers> top);
  /// What is filled.
  static bool has_reflection(const Appearance& appearance);
  static bool has_glass(const Appearance& appearance);
  /// Between those of two appearances that differ in roughness only. share: 0 gives a, bit for bit.
  static AlbedoTables between(const AlbedoTables& a, const AlbedoTables& b, float share);
};

/// Probabilities of sampling the lobes, as seen from one direction.
struct LobeShares {
  float sheen = 0, coat = 0, reflection = 0, cosine = 0, subsurface = 0, glass = 0;
};

/// A material seen from one direction: what all light that comes from there, or goes there, has in common.
struct BsdfView {
  Vec3f o = Vec3f::Zero();
  bool inside = false;
  float passed = 1;          ///< past coat and sheen
  Vec2f e = Vec2f::Zero();   ///< of the reflection's albedo table
  float diffuse_passed = 1;  ///< past all that is above the diffuse lobe
  float lambda = 0;          ///< ggx_lambda of the base
  LobeShares shares;
};

/// One prepared material. Directions are local, unit, and point away from the surface; `o` towards the viewer, on the
/// side of +z. `inside`: +z is the inside of the body.
class Bsdf {
 public:
  explicit Bsdf(const Appearance& appearance) : Bsdf(appearance, AlbedoTables::of(appearance)) {}
  /// Quick; tables: those of an appearance that differs in base colour only, or between those of two neighbours.
  Bsdf(const Appearance& appearance, const AlbedoTables& tables);

  BsdfView seen_from(const Vec3f& o, bool inside) const {
    BsdfView view;
    view.o = o;
    view.inside = inside;
    if (!lambertian_) look_from(view);
    return view;
  }
  BsdfValue evaluate(const BsdfView& view, const Vec3f& i) const {
    return lambertian_ ? lambert(i.z()) : evaluate_lobes(view, i);
  }
  /// Numbers in [0, 1). u: for the lobe and the direction in it; side: for what rough or smooth glass does with it.
  /// False if the sample carries nothing.
  bool sample(const BsdfView& view, float side, const Vec2f& u, BsdfSample& sample) const;

  BsdfValue evaluate(const Vec3f& o, const Vec3f& i, bool inside) const { return evaluate(seen_from(o, inside), i); }
  bool sample(const Vec3f& o, float side, const Vec2f& u, bool inside, BsdfSample& out) const {
    return sample(seen_from(o, inside), side, u, out);
  }

  /// Whether evaluate() can be above 0, so that sampling lights makes sense.
  bool has_smooth_part() const { return has_cosine_lobe_ || !mirror_ || (top_ && top_->has_smooth_part()); }
  /// Whether a lamp's reflection may be narrower than the lamp: a lobe that is neither a mirror nor wide.
  bool has_highlight() const { return has_highlight_; }
  bool transmits() const { return glass_ > 0; }
  const Vec3f& absorption() const { return absorption_; }
  const Vec3f& emission() const { return emission_; }
  /// What the albedo channel shows.
  const Vec3f& albedo() const { return albedo_; }

  /// How light that a `subsurface` sample took inside is scattered there. From behind such a surface is diffuse.
  const Subsurface& subsurface() const { return inside_; }
  /// How that light leaves where it comes out: value and density, by the cosine to the projected hemisphere, towards i.
  BsdfValue evaluate_leaving(const Vec3f& i) const;

 private:
  /// The rest of a view, if there is more than the diffuse lobe.
  void look_from(BsdfView& view) const;
  BsdfValue lambert(float cos_i) const {
    if (cos_i <= 0) return {};
    return {diffuse_ * (cos_i / kPi), cos_i / kPi};
  }
  BsdfValue evaluate_lobes(const BsdfView& view, const Vec3f& i) const;
  LobeShares shares(const BsdfView& view) const;
  void prepare_metal(const Appearance& appearance);
  Vec3f reflectance(float cosine) const { return f0_ + (f90_ - f0_) * schlick_weight(cosine); }
  /// Of light that reaches the base; 1 without layers.
  float passed(float cosine) const { return top_ ? top_->passed(cosine) : 1.0f; }
  float mean_passed() const { return top_ ? top_->mean_passed() : 1.0f; }
  /// Share of light that gets past all that is above the diffuse lobe; e: of ggx_albedo_.
  float diffuse_passed(float cosine, const Vec2f& e) const;
  const Vec3f& diffuse(bool inside) const { return inside ? diffuse_from_behind_ : diffuse_; }
  Vec3f cosine_lobe(const BsdfView& view, float cos_i) const;
  void add_reflection(const BsdfView& view, const Vec3f& i, BsdfValue& sum) const;
  void add_glass(const BsdfView& view, const Vec3f& i, BsdfValue& sum) const;
  void add_base(const BsdfView& view, const Vec3f& i, BsdfValue& sum) const;

  /// What drawing a lobe has settled: nothing is carried, all of the sample, or its direction only.
  enum class Drawn { Nothing, Whole, Direction };
  Drawn draw(const BsdfView& view, float side, const Vec2f& u, BsdfSample& sample) const;
  Drawn draw_subsurface(const BsdfView& view, const Vec2f& u, BsdfSample& sample) const;
  Drawn draw_coat(const BsdfView& view, const Vec2f& u, BsdfSample& sample) const;
  Drawn draw_reflection(const BsdfView& view, const Vec2f& u, BsdfSample& sample) const;
  Drawn draw_mirror_glass(const Vec3f& o, float u, float eta, float share, BsdfSample& sample) const;
  Vec3f sample_rough_glass(const Vec3f& o, float u_side, const Vec2f& u, float eta) const;

  float alpha_;
  bool mirror_;        ///< GGX is perfectly smooth
  bool smooth_glass_;  ///< and the glass, or it bends no light
  bool lambertian_;    ///< only the diffuse lobe, nothing over it
  bool has_highlight_;
  bool has_cosine_lobe_;  ///< from one side at least
  float glass_;           ///< weight of the glass lobe
  float ior_;
  float dielectric_f0_;
  Vec3f f0_, f90_;                                 ///< reflectances of dielectric and metal, with their weights
  Vec3f diffuse_;                                  ///< albedo under the dielectric, with weight
  Vec3f diffuse_from_behind_;                      ///< the same and the subsurface lobe's
  float diffuse_scale_ = 1;                        ///< 1 / (mean of diffuse_passed)
  float subsurface_ = 0;                           ///< weight of the subsurface lobe
  Vec3f metal_return_ = Vec3f::Zero();             ///< of multiple scattering among facets, with weight
  float most_diffuse_, most_diffuse_from_behind_;  ///< largest components of the above
  float most_returned_;                            ///< and of metal_return_
  float mean_lost_;                                ///< by the reflection, of what arrives, weighted by 2 mu
  Vec3f absorption_, emission_, albedo_;
  Subsurface inside_;
  AlbedoTable ggx_albedo_, glass_outside_, glass_inside_;
  std::shared_ptr<const TopLayers> top_;
};

}  // namespace softreel
