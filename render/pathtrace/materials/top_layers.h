/// Layers over a whole material: clear varnish (coat), and above it fibres (sheen).
///
/// What they return is theirs; what is below gets what they let through, on the way in and on the way out, and loses
/// what the varnish's tint takes: Beer's law along the refracted ray. Below them peaked lobes count
/// min(passed(o), passed(i)), as in Estevez and Kulla 2017: reciprocal, and never more than arrives.
#pragma once

#include <memory>

#include "render/pathtrace/materials/albedo_table.h"
#include "render/pathtrace/materials/scattering.h"
#include "render/pathtrace/materials/sheen.h"
#include "render/scene/material.h"

namespace softreel {

class TopLayers {
 public:
  /// Whether the material has coat or sheen.
  static bool has_any(const Appearance& appearance) { return appearance.coat > 0 || appearance.sheen > 0; }
  /// Null if it has neither.
  static std::shared_ptr<const TopLayers> make(const Appearance& appearance);
  explicit TopLayers(const Appearance& appearance);

  /// Share of white light, untinted, that reaches the base from a direction; its mean, weighted by 2 mu.
  float passed(float cosine) const { return passed_.at(cosine).x(); }
  float mean_passed() const { return passed_.mean().x(); }
  /// What one way through the varnish leaves of the colours.
  Vec3f tint(float cosine) const;

  /// Expected shares of the lobes, for choosing one to sample.
  float sheen_share(float cosine) const { return sheen_ ? sheen_color_.maxCoeff() * sheen_->albedo(cosine) : 0.0f; }
  float coat_share(float cosine) const;

  /// Adds value and density of both lobes, each chosen with the given probability.
  void add(const Vec3f& o, const Vec3f& i, float sheen_probability, float coat_probability, BsdfValue& sum) const;
  /// A direction by the sheen's density; always above the surface.
  static Vec3f sample_sheen(const Vec2f& u);
  /// A direction by the coat's density; false if it goes below the surface.
  bool sample_coat(const Vec3f& o, const Vec2f& u, Vec3f& direction) const;

  bool has_coat() const { return coat_ > 0; }
  /// The coat is a mirror: its one direction carries coat_share. Or so rough that no details show in it.
  bool mirror_coat() const;
  bool wide_coat() const;
  /// Whether add() can add anything.
  bool has_smooth_part() const { return sheen_ != nullptr || (has_coat() && !mirror_coat()); }

 private:
  /// Share that the sheen lets through.
  float under_sheen(float cosine) const { return 1 - sheen_share(cosine); }

  std::shared_ptr<const Sheen> sheen_;  ///< null: none
  Vec3f sheen_color_;                   ///< with the sheen's weight
  float coat_;                          ///< weight
  float coat_alpha_, coat_f0_, coat_ior_;
  Vec3f tint_density_;  ///< optical depth of the varnish, straight through
  AlbedoTable coat_albedo_;
  AlbedoTable passed_;
};

}  // namespace softreel
