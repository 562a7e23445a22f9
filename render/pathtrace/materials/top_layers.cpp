#include "render/pathtrace/materials/top_layers.h"

#include "core/base/check.h"
#include "render/pathtrace/materials/microfacet.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {

std::shared_ptr<const TopLayers> TopLayers::make(const Appearance& appearance) {
  if (!has_any(appearance)) return nullptr;
  return std::make_shared<const TopLayers>(appearance);
}

TopLayers::TopLayers(const Appearance& appearance)
    : sheen_color_(appearance.sheen * appearance.sheen_color),
      coat_(appearance.coat),
      coat_alpha_(appearance.coat_roughness * appearance.coat_roughness),
      coat_ior_(appearance.coat_ior) {
  if (appearance.sheen > 0) sheen_ = std::make_shared<const Sheen>(appearance.sheen_roughness);
  const float slope = (coat_ior_ - 1) / (coat_ior_ + 1);
  coat_f0_ = slope * slope;
  CHECK(appearance.coat_color.minCoeff() > 0);
  // The colour is that of white seen through the varnish: two ways.
  tint_density_ = -0.5f * appearance.coat_color.array().log().matrix();
  if (has_coat()) coat_albedo_ = AlbedoTable::of_reflection(coat_alpha_, [this](float mu) { return under_sheen(mu); });
  passed_ = AlbedoTable::of([this](float mu) { return Vec2f(under_sheen(mu) - coat_share(mu), 0); });
}

float TopLayers::coat_share(float cosine) const {
  if (!has_coat()) return 0;
  const Vec2f e = coat_albedo_.at(cosine);
  return coat_ * (coat_f0_ * e.x() + e.y());
}

bool TopLayers::mirror_coat() const {
  return has_coat() && coat_alpha_ < kSmoothAlpha;
}

bool TopLayers::wide_coat() const {
  return coat_alpha_ >= kWideAlpha;
}

Vec3f TopLayers::tint(float cosine) const {
  if (!has_coat() || !(tint_density_.maxCoeff() > 0)) return Vec3f::Ones();
  const float refracted = std::sqrt(std::max(1e-6f, 1 - (1 - cosine * cosine) / (coat_ior_ * coat_ior_)));
  const Vec3f through = (-tint_density_ / refracted).array().exp().matrix();
  return Vec3f::Constant(1 - coat_) + coat_ * through;
}

void TopLayers::add(const Vec3f& o, const Vec3f& i, float sheen_probability, float coat_probability,
                    BsdfValue& sum) const {
  if (sheen_ != nullptr) {
    sum.value += sheen_color_ * sheen_->value(o, i);
    sum.pdf += sheen_probability / (2 * kPi);
  }
  if (!has_coat() || mirror_coat()) return;
  const Vec3f h = (o + i).normalized();
  const float common = ggx_distribution(h.z(), coat_alpha_) / (4 * o.z());
  const float lambda_o = ggx_lambda(o.z(), coat_alpha_), lambda_i = ggx_lambda(i.z(), coat_alpha_);
  const float fresnel = coat_f0_ + (1 - coat_f0_) * schlick_weight(o.dot(h));
  const float seen = std::min(under_sheen(o.z()), under_sheen(i.z()));
  sum.value += Vec3f::Constant(coat_ * seen * fresnel * common / (1 + lambda_o + lambda_i));
  sum.pdf += coat_probability * common / (1 + lambda_o);
}

Vec3f TopLayers::sample_sheen(const Vec2f& u) {
  return uniform_cone(u, 1);
}

bool TopLayers::sample_coat(const Vec3f& o, const Vec2f& u, Vec3f& direction) const {
  const Vec3f h = sample_visible_normal(o, coat_alpha_, u);
  direction = 2 * o.dot(h) * h - o;
  return direction.z() > 0;
}

}  // namespace softreel
