#include "render/pathtrace/bsdf.h"

#include "render/pathtrace/sampling.h"

namespace softreel {

namespace {

/// Sampling weight G2 / G1 of a direction with cosine `cos_i`, which may be on either side.
float shadowing_weight(const Vec3f& o, float cos_i, float alpha) {
  return ggx_shadowing(o.z(), std::abs(cos_i), alpha) / ggx_masking(o.z(), alpha);
}

}  // namespace

AlbedoTables AlbedoTables::of(const Appearance& appearance) {
  AlbedoTables tables;
  tables.top = TopLayers::make(appearance);
  const float alpha = appearance.roughness * appearance.roughness;
  const bool glass = (1 - appearance.metallic) * appearance.transmission > 0;
  if (tables.top)
    tables.reflection = AlbedoTable::of_reflection(alpha, [&](float mu) { return tables.top->passed(mu); });
  else if (glass || appearance.specular > 0 || appearance.metallic > 0 || appearance.subsurface > 0)
    tables.reflection = AlbedoTable::of_reflection(alpha);
  if (glass) {
    tables.glass_outside = AlbedoTable::of_glass(alpha, appearance.ior);
    tables.glass_inside = AlbedoTable::of_glass(alpha, 1 / appearance.ior);
  }
  return tables;
}

AlbedoTables AlbedoTables::between(const AlbedoTables& a, const AlbedoTables& b, float share) {
  return {AlbedoTable::between(a.reflection, b.reflection, share),
          AlbedoTable::between(a.glass_outside, b.glass_outside, share),
          AlbedoTable::between(a.glass_inside, b.glass_inside, share), a.top};
}

Bsdf::Bsdf(const Appearance& appearance, const AlbedoTables& tables)
    : alpha_(appearance.roughness * appearance.roughness),
      mirror_(alpha_ < kSmoothAlpha),
      glass_((1 - appearance.metallic) * appearance.transmission),
      ior_(appearance.ior),
      dielectric_f0_(0.08f * appearance.specular),
      absorption_(appearance.absorption),
      emission_(appearance.emission),
      albedo_(appearance.base_color),
      inside_{appearance.base_color, appearance.subsurface_scale * appearance.subsurface_radius,
              appearance.subsurface_anisotropy},
      ggx_albedo_(tables.reflection),
      glass_outside_(tables.glass_outside),
      glass_inside_(tables.glass_inside),
      top_(tables.top) {
  const float metal = appearance.metallic;
  const float base = (1 - metal) * (1 - appearance.transmission);
  const bool coated = dielectric_f0_ > 0;
  f0_ = metal * appearance.metal_color.value_or(appearance.base_color) + Vec3f::Constant(base * dielectric_f0_);
  f90_ = Vec3f::Constant(metal + (coated ? base : 0.0f));
  subsurface_ = base * appearance.subsurface;
  diffuse_from_behind_ = base * appearance.base_color;
  diffuse_ = (1 - appearance.subsurface) * diffuse_from_behind_;
  lambertian_ = !coated && metal == 0 && glass_ == 0 && subsurface_ == 0 && !top_;
  const Vec2f mean = ggx_albedo_.mean();
  if (coated || top_) diffuse_scale_ = 1 / (mean_passed() - (dielectric_f0_ * mean.x() + (coated ? mean.y() : 0.0f)));
  if (metal > 0) prepare_metal(appearance);
  has_cosine_lobe_ = diffuse_from_behind_.maxCoeff() > 0 || metal_return_.maxCoeff() > 0;
}

/// Kulla and Conty: light that leaves after several reflections, coloured once more by each.
void Bsdf::prepare_metal(const Appearance& appearance) {
  const float lost = mean_passed() - ggx_albedo_.mean().sum();
  if (lost <= 1e-5f) return;
  const float once = ggx_albedo_.mean().sum() / mean_passed();
  const Vec3f metal_color = appearance.metal_color.value_or(appearance.base_color);
  const Vec3f f_mean = metal_color + (Vec3f::Ones() - metal_color) / 21;
  const Vec3f f_return = (f_mean.array().square() * once / (1 - f_mean.array() * (1 - once))).matrix();
  metal_return_ = appearance.metallic / lost * f_return;
}

float Bsdf::diffuse_passed(float cosine, const Vec2f& e) const {
  return passed(cosine) - (dielectric_f0_ * e.x() + (dielectric_f0_ > 0 ? e.y() : 0.0f));
}

Bsdf::Shares Bsdf::shares(float cosine, bool inside) const {
  const Vec2f e = ggx_albedo_.at(cosine);
  const float past = diffuse_passed(cosine, e);
  const float reflected = (f0_ * e.x() + f90_ * e.y()).maxCoeff();
  const float under = diffuse(inside).maxCoeff() * past;
  const float returned =
      metal_return_.maxCoeff() * (passed(cosine) - (e.x() + e.y())) * (mean_passed() - ggx_albedo_.mean().sum());
  Shares p;
  p.reflection = reflected;
  p.cosine = has_cosine_lobe_ ? under + std::max(0.0f, returned) : 0.0f;
  p.glass = top_ ? glass_ * passed(cosine) : glass_;
  p.subsurface = inside ? 0.0f : subsurface_ * past * inside_.color.maxCoeff();
  if (top_) {
    p.sheen = top_->sheen_share(cosine);
    p.coat = top_->coat_share(cosine);
  }
  const float total = p.reflection + p.cosine + p.glass + (p.subsurface + p.sheen + p.coat);
  if (!(total > 0)) return {};
  for (float* share : {&p.sheen, &p.coat, &p.reflection, &p.cosine, &p.subsurface, &p.glass}) *share /= total;
  return p;
}

Vec3f Bsdf::cosine_lobe(float cos_o, float cos_i, bool inside) const {
  constexpr float kInvPi = 1 / kPi;
  const Vec2f eo = ggx_albedo_.at(cos_o), ei = ggx_albedo_.at(cos_i);
  Vec3f sum = metal_return_ * ((passed(cos_o) - eo.sum()) * (passed(cos_i) - ei.sum()));
  sum += diffuse(inside) * (diffuse_scale_ * diffuse_passed(cos_o, eo) * diffuse_passed(cos_i, ei));
  return sum * (cos_i * kInvPi);
}

void Bsdf::add_reflection(const Vec3f& o, const Vec3f& i, float share, BsdfValue& sum) const {
  const Vec3f h = (o + i).normalized();
  const float cos_d = o.dot(h);
  const float distribution = ggx_distribution(h.z(), alpha_);
  const float lambda_o = ggx_lambda(o.z(), alpha_), lambda_i = ggx_lambda(i.z(), alpha_);
  const float common = distribution / (4 * o.z());
  const float seen = top_ ? std::min(passed(o.z()), passed(i.z())) : 1.0f;
  sum.value += reflectance(cos_d) * (seen * common / (1 + lambda_o + lambda_i));
  sum.pdf += share * common / (1 + lambda_o);
}

void Bsdf::add_glass(const Vec3f& o, const Vec3f& i, bool inside, float share, BsdfValue& sum) const {
  const float eta = inside ? 1 / ior_ : ior_;
  const bool reflected = i.z() > 0;
  Vec3f h = reflected ? Vec3f(o + i) : Vec3f(-(o + eta * i));
  // Indices below 1 (light leaving the glass) turn the generalised half vector to the other side.
  if (h.z() < 0) h = -h;
  const float length = h.norm();
  if (!(length > 1e-6f)) return;
  h /= length;
  const float o_h = o.dot(h), i_h = i.dot(h);
  if (o_h <= 0 || (reflected ? i_h <= 0 : i_h >= 0)) return;
  const float fresnel = fresnel_dielectric(o_h, eta);
  const float visible = visible_normal_density(o, h, alpha_);
  const float kept = (inside ? glass_inside_ : glass_outside_).at(o.z()).sum();
  const float denominator = i_h + o_h / eta;
  const float pdf =
      reflected ? fresnel * visible / (4 * o_h) : (1 - fresnel) * visible * std::abs(i_h) / (denominator * denominator);
  sum.value += Vec3f::Constant(glass_ * passed(o.z()) * pdf * shadowing_weight(o, i.z(), alpha_) / kept);
  sum.pdf += share * pdf;
}

BsdfValue Bsdf::evaluate_leaving(const Vec3f& i) const {
  if (i.z() <= 0) return {};
  const float density = i.z() / kPi;
  const float passed_out = diffuse_scale_ * diffuse_passed(i.z(), ggx_albedo_.at(i.z()));
  const Vec3f tint = top_ ? top_->tint(i.z()) : Vec3f(Vec3f::Ones());
  return {tint * (passed_out * density), density};
}

void Bsdf::add_base(const Vec3f& o, const Vec3f& i, bool inside, const Shares& p, BsdfValue& sum) const {
  if (i.z() > 0) {
    if (has_cosine_lobe_) {
      sum.value += cosine_lobe(o.z(), i.z(), inside);
      sum.pdf += p.cosine * i.z() / kPi;
    }
    if (!mirror_ && p.reflection > 0) add_reflection(o, i, p.reflection, sum);
  }
  if (glass_ > 0 && !mirror_ && i.z() != 0) add_glass(o, i, inside, p.glass, sum);
}

BsdfValue Bsdf::evaluate(const Vec3f& o, const Vec3f& i, bool inside) const {
  BsdfValue sum;
  if (lambertian_) {
    if (i.z() <= 0) return sum;
    return {diffuse_ * (i.z() / kPi), i.z() / kPi};
  }
  const Shares p = shares(o.z(), inside);
  add_base(o, i, inside, p, sum);
  if (!top_) return sum;
  sum.value = sum.value.cwiseProduct(top_->tint(o.z()));
  if (i.z() <= 0) return sum;
  sum.value = sum.value.cwiseProduct(top_->tint(i.z()));
  top_->add(o, i, p.sheen, p.coat, sum);
  return sum;
}

Bsdf::Drawn Bsdf::draw_mirror_glass(const Vec3f& o, float u, float eta, float share, BsdfSample& sample) const {
  sample.mirror = true;
  sample.weight = Vec3f::Constant(glass_ * passed(o.z()) / share);
  if (top_) sample.weight = sample.weight.cwiseProduct(top_->tint(o.z()));
  sample.pdf = 0;
  if (u >= fresnel_dielectric(o.z(), eta))
    return refract(o, Vec3f(0, 0, 1), eta, sample.direction) ? Drawn::Whole : Drawn::Nothing;
  sample.direction = Vec3f(-o.x(), -o.y(), o.z());
  if (top_) sample.weight = sample.weight.cwiseProduct(top_->tint(o.z()));
  return Drawn::Whole;
}

/// Zero if the facet sends the light to the wrong side of the surface.
Vec3f Bsdf::sample_rough_glass(const Vec3f& o, float u_side, const Vec2f& u, float eta) const {
  const Vec3f h = sample_visible_normal(o, alpha_, u);
  const float o_h = o.dot(h);
  Vec3f i;
  if (u_side < fresnel_dielectric(o_h, eta)) {
    i = 2 * o_h * h - o;
    return i.z() > 0 ? i : Vec3f::Zero();
  }
  return refract(o, h, eta, i) && i.z() < 0 ? i : Vec3f::Zero();
}

Bsdf::Drawn Bsdf::draw_reflection(const Vec3f& o, const Vec2f& u, float share, BsdfSample& sample) const {
  if (mirror_) {
    sample.direction = Vec3f(-o.x(), -o.y(), o.z());
    sample.weight = reflectance(o.z()) * passed(o.z()) / share;
    if (top_) sample.weight = sample.weight.cwiseProduct(top_->tint(o.z()).array().square().matrix());
    sample.mirror = true;
    sample.pdf = 0;
    return Drawn::Whole;
  }
  const Vec3f h = sample_visible_normal(o, alpha_, u);
  sample.direction = 2 * o.dot(h) * h - o;
  return sample.direction.z() > 0 ? Drawn::Direction : Drawn::Nothing;
}

Bsdf::Drawn Bsdf::draw_layer(const Vec3f& o, float lobe, const Vec2f& u, const Shares& p, BsdfSample& sample) const {
  sample.wide = true;
  if (lobe < p.sheen) {
    sample.direction = TopLayers::sample_sheen(u);
    return sample.direction.z() > 0 ? Drawn::Direction : Drawn::Nothing;
  }
  if (lobe < p.sheen + p.subsurface) {
    // Enters as it would leave: evenly over the projected hemisphere.
    sample.direction = -cosine_hemisphere(u);
    sample.weight = Vec3f::Constant(subsurface_ * diffuse_passed(o.z(), ggx_albedo_.at(o.z())) / p.subsurface);
    if (top_) sample.weight = sample.weight.cwiseProduct(top_->tint(o.z()));
    sample.subsurface = true;
    sample.pdf = 0;
    return Drawn::Whole;
  }
  sample.wide = top_->wide_coat();
  if (!top_->mirror_coat()) return top_->sample_coat(o, u, sample.direction) ? Drawn::Direction : Drawn::Nothing;
  sample.direction = Vec3f(-o.x(), -o.y(), o.z());
  sample.weight = Vec3f::Constant(top_->coat_share(o.z()) / p.coat);
  sample.mirror = true;
  sample.pdf = 0;
  return Drawn::Whole;
}

Bsdf::Drawn Bsdf::draw_base(const Vec3f& o, float lobe, const Vec2f& u, bool inside, const Shares& p,
                            BsdfSample& sample) const {
  sample.wide = alpha_ >= kWideAlpha;
  if (lobe < p.cosine) {
    sample.direction = cosine_hemisphere(u);
    sample.wide = true;
    return Drawn::Direction;
  }
  if (lobe < p.cosine + p.reflection) return draw_reflection(o, u, p.reflection, sample);
  if (!(p.glass > 0)) return Drawn::Nothing;
  const float eta = inside ? 1 / ior_ : ior_;
  const float side = std::clamp((lobe - p.cosine - p.reflection) / p.glass, 0.0f, 0x1.fffffep-1f);
  if (mirror_) return draw_mirror_glass(o, side, eta, p.glass, sample);
  sample.direction = sample_rough_glass(o, side, u, eta);
  return sample.direction.z() != 0 ? Drawn::Direction : Drawn::Nothing;
}

bool Bsdf::sample(const Vec3f& o, float lobe, const Vec2f& u, bool inside, BsdfSample& sample) const {
  sample.mirror = sample.subsurface = false;
  if (lambertian_) {
    sample.direction = cosine_hemisphere(u);
    sample.weight = diffuse_;
    sample.pdf = sample.direction.z() / kPi;
    sample.wide = true;
    return sample.pdf > 0;
  }
  const Shares p = shares(o.z(), inside);
  const float layers = p.sheen + p.subsurface + p.coat;
  const Drawn drawn =
      lobe < layers ? draw_layer(o, lobe, u, p, sample) : draw_base(o, lobe - layers, u, inside, p, sample);
  if (drawn != Drawn::Direction) return drawn == Drawn::Whole;
  const BsdfValue value = evaluate(o, sample.direction, inside);
  if (!(value.pdf > 0)) return false;
  sample.pdf = value.pdf;
  sample.weight = value.value / value.pdf;
  return true;
}

}  // namespace softreel
