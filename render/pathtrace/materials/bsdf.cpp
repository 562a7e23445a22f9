#include "render/pathtrace/materials/bsdf.h"

#include <utility>

#include "render/pathtrace/rays/sampling.h"

namespace softreel {

namespace {

/// The second of two numbers falls into the share of one lobe, and its place within it is a number again. So the points
/// of each lobe are as evenly spread as all are, where a number of its own would leave out some of them by chance.
class LobeChoice {
 public:
  explicit LobeChoice(const Vec2f& u) : u_(u) {}
  /// Asked once a lobe, in turn, until it does.
  bool falls_into(float share) {
    if (u_.y() >= share) {
      u_.y() -= share;
      return false;
    }
    u_.y() = std::min(u_.y() / share, 0x1.fffffep-1f);
    return true;
  }
  const Vec2f& point() const { return u_; }

 private:
  Vec2f u_;
};

/// Glass as dense as the air bends no light, however rough it is: less than a thousandth of the slope of a facet.
bool bends_light(float ior) {
  return std::abs(ior - 1) >= 1e-3f;
}

}  // namespace

AlbedoTables AlbedoTables::of(const Appearance& appearance, std::shared_ptr<const TopLayers> top) {
  AlbedoTables tables;
  tables.top = std::move(top);
  const float alpha = appearance.roughness * appearance.roughness;
  const float glass_alpha = bends_light(appearance.ior) ? alpha : 0;
  if (tables.top)
    tables.reflection = AlbedoTable::of_reflection(alpha, [&](float mu) { return tables.top->passed(mu); });
  else if (has_reflection(appearance))
    tables.reflection = AlbedoTable::of_reflection(alpha);
  if (has_glass(appearance)) {
    tables.glass_outside = AlbedoTable::of_glass(glass_alpha, appearance.ior);
    tables.glass_inside = AlbedoTable::of_glass(glass_alpha, 1 / appearance.ior);
  }
  return tables;
}

bool AlbedoTables::has_glass(const Appearance& appearance) {
  return (1 - appearance.metallic) * appearance.transmission > 0;
}

bool AlbedoTables::has_reflection(const Appearance& appearance) {
  return TopLayers::has_any(appearance) || has_glass(appearance) || appearance.specular > 0 ||
         appearance.metallic > 0 || appearance.subsurface > 0;
}

AlbedoTables AlbedoTables::between(const AlbedoTables& a, const AlbedoTables& b, float share) {
  return {AlbedoTable::between(a.reflection, b.reflection, share),
          AlbedoTable::between(a.glass_outside, b.glass_outside, share),
          AlbedoTable::between(a.glass_inside, b.glass_inside, share), a.top};
}

Bsdf::Bsdf(const Appearance& appearance, const AlbedoTables& tables)
    : alpha_(appearance.roughness * appearance.roughness),
      mirror_(alpha_ < kSmoothAlpha),
      smooth_glass_(mirror_ || !bends_light(appearance.ior)),
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
  most_diffuse_ = diffuse_.maxCoeff();
  most_diffuse_from_behind_ = diffuse_from_behind_.maxCoeff();
  most_returned_ = metal_return_.maxCoeff();
  mean_lost_ = mean_passed() - mean.sum();
  const bool coat_shines = top_ && top_->has_coat() && !top_->mirror_coat() && !top_->wide_coat();
  has_highlight_ = coat_shines || (!mirror_ && alpha_ < kWideAlpha && f90_.maxCoeff() > 0);
  has_cosine_lobe_ = most_diffuse_from_behind_ > 0 || most_returned_ > 0;
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

void Bsdf::look_from(BsdfView& view) const {
  const float cosine = view.o.z();
  view.passed = passed(cosine);
  view.e = ggx_albedo_.at(cosine);
  view.diffuse_passed = diffuse_passed(cosine, view.e);
  view.lambda = ggx_lambda(cosine, alpha_);
  view.shares = shares(view);
}

inline LobeShares Bsdf::shares(const BsdfView& view) const {
  const float cosine = view.o.z();
  const float reflected = (f0_ * view.e.x() + f90_ * view.e.y()).maxCoeff();
  const float under = (view.inside ? most_diffuse_from_behind_ : most_diffuse_) * view.diffuse_passed;
  const float returned = most_returned_ * (view.passed - (view.e.x() + view.e.y())) * mean_lost_;
  LobeShares p;
  p.reflection = reflected;
  p.cosine = has_cosine_lobe_ ? under + std::max(0.0f, returned) : 0.0f;
  p.glass = top_ ? glass_ * view.passed : glass_;
  p.subsurface = view.inside ? 0.0f : subsurface_ * view.diffuse_passed * inside_.color.maxCoeff();
  if (top_) {
    p.sheen = top_->sheen_share(cosine);
    p.coat = top_->coat_share(cosine);
  }
  const float total = p.reflection + p.cosine + p.glass + (p.subsurface + p.sheen + p.coat);
  if (!(total > 0)) return {};
  const float scale = 1 / total;
  return {p.sheen * scale,  p.coat * scale,       p.reflection * scale,
          p.cosine * scale, p.subsurface * scale, p.glass * scale};
}

inline Vec3f Bsdf::cosine_lobe(const BsdfView& view, float cos_i) const {
  constexpr float kInvPi = 1 / kPi;
  const Vec2f ei = ggx_albedo_.at(cos_i);
  Vec3f sum = Vec3f::Zero();
  if (most_returned_ > 0) sum = metal_return_ * ((view.passed - view.e.sum()) * (passed(cos_i) - ei.sum()));
  sum += diffuse(view.inside) * (diffuse_scale_ * view.diffuse_passed * diffuse_passed(cos_i, ei));
  return sum * (cos_i * kInvPi);
}

[[gnu::always_inline]] inline void Bsdf::add_reflection(const BsdfView& view, const Vec3f& i, BsdfValue& sum) const {
  const Vec3f& o = view.o;
  const Vec3f h = (o + i).normalized();
  const float cos_d = o.dot(h);
  const float distribution = ggx_distribution(h.z(), alpha_);
  const float lambda_i = ggx_lambda(i.z(), alpha_);
  const float common = distribution / (4 * o.z());
  const float seen = top_ ? std::min(view.passed, passed(i.z())) : 1.0f;
  sum.value += reflectance(cos_d) * (seen * common / (1 + view.lambda + lambda_i));
  sum.pdf += view.shares.reflection * common / (1 + view.lambda);
}

void Bsdf::add_glass(const BsdfView& view, const Vec3f& i, BsdfValue& sum) const {
  const Vec3f& o = view.o;
  const float eta = view.inside ? 1 / ior_ : ior_;
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
  const float kept = (view.inside ? glass_inside_ : glass_outside_).at(o.z()).sum();
  const float denominator = i_h + o_h / eta;
  const float pdf =
      reflected ? fresnel * visible / (4 * o_h) : (1 - fresnel) * visible * std::abs(i_h) / (denominator * denominator);
  sum.value += Vec3f::Constant(glass_ * view.passed * pdf * shadowing_weight(o, i.z(), alpha_) / kept);
  sum.pdf += view.shares.glass * pdf;
}

BsdfValue Bsdf::evaluate_leaving(const Vec3f& i) const {
  if (i.z() <= 0) return {};
  const float density = i.z() / kPi;
  const float passed_out = diffuse_scale_ * diffuse_passed(i.z(), ggx_albedo_.at(i.z()));
  const Vec3f tint = top_ ? top_->tint(i.z()) : Vec3f(Vec3f::Ones());
  return {tint * (passed_out * density), density};
}

inline void Bsdf::add_base(const BsdfView& view, const Vec3f& i, BsdfValue& sum) const {
  if (i.z() > 0) {
    if (has_cosine_lobe_) {
      sum.value += cosine_lobe(view, i.z());
      sum.pdf += view.shares.cosine * i.z() / kPi;
    }
    if (!mirror_ && view.shares.reflection > 0) add_reflection(view, i, sum);
  }
  if (glass_ > 0 && !smooth_glass_ && i.z() != 0) add_glass(view, i, sum);
}

BsdfValue Bsdf::evaluate_lobes(const BsdfView& view, const Vec3f& i) const {
  BsdfValue sum;
  add_base(view, i, sum);
  if (!top_) return sum;
  sum.value = sum.value.cwiseProduct(top_->tint(view.o.z()));
  if (i.z() <= 0) return sum;
  sum.value = sum.value.cwiseProduct(top_->tint(i.z()));
  top_->add(view.o, i, view.shares.sheen, view.shares.coat, sum);
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

Bsdf::Drawn Bsdf::draw_reflection(const BsdfView& view, const Vec2f& u, BsdfSample& sample) const {
  const Vec3f& o = view.o;
  if (mirror_) {
    sample.direction = Vec3f(-o.x(), -o.y(), o.z());
    sample.weight = reflectance(o.z()) * view.passed / view.shares.reflection;
    if (top_) sample.weight = sample.weight.cwiseProduct(top_->tint(o.z()).array().square().matrix());
    sample.mirror = true;
    sample.pdf = 0;
    return Drawn::Whole;
  }
  const Vec3f h = sample_visible_normal(o, alpha_, u);
  sample.direction = 2 * o.dot(h) * h - o;
  return sample.direction.z() > 0 ? Drawn::Direction : Drawn::Nothing;
}

Bsdf::Drawn Bsdf::draw_subsurface(const BsdfView& view, const Vec2f& u, BsdfSample& sample) const {
  // Enters as it would leave: evenly over the projected hemisphere.
  sample.direction = -cosine_hemisphere(u);
  sample.weight = Vec3f::Constant(subsurface_ * view.diffuse_passed / view.shares.subsurface);
  if (top_) sample.weight = sample.weight.cwiseProduct(top_->tint(view.o.z()));
  sample.subsurface = true;
  sample.pdf = 0;
  return Drawn::Whole;
}

Bsdf::Drawn Bsdf::draw_coat(const BsdfView& view, const Vec2f& u, BsdfSample& sample) const {
  const Vec3f& o = view.o;
  sample.wide = top_->wide_coat();
  if (!top_->mirror_coat()) return top_->sample_coat(o, u, sample.direction) ? Drawn::Direction : Drawn::Nothing;
  sample.direction = Vec3f(-o.x(), -o.y(), o.z());
  sample.weight = Vec3f::Constant(top_->coat_share(o.z()) / view.shares.coat);
  sample.mirror = true;
  sample.pdf = 0;
  return Drawn::Whole;
}

Bsdf::Drawn Bsdf::draw(const BsdfView& view, float side, const Vec2f& u, BsdfSample& sample) const {
  const LobeShares& p = view.shares;
  LobeChoice choice(u);
  sample.wide = true;
  if (choice.falls_into(p.sheen)) {
    sample.direction = TopLayers::sample_sheen(choice.point());
    return sample.direction.z() > 0 ? Drawn::Direction : Drawn::Nothing;
  }
  if (choice.falls_into(p.subsurface)) return draw_subsurface(view, choice.point(), sample);
  if (choice.falls_into(p.coat)) return draw_coat(view, choice.point(), sample);
  if (choice.falls_into(p.cosine)) {
    sample.direction = cosine_hemisphere(choice.point());
    return Drawn::Direction;
  }
  sample.wide = alpha_ >= kWideAlpha;
  if (choice.falls_into(p.reflection)) return draw_reflection(view, choice.point(), sample);
  if (!choice.falls_into(p.glass)) return Drawn::Nothing;  // all shares together are 1 up to rounding
  const float eta = view.inside ? 1 / ior_ : ior_;
  if (smooth_glass_) return draw_mirror_glass(view.o, side, eta, p.glass, sample);
  sample.direction = sample_rough_glass(view.o, side, choice.point(), eta);
  return sample.direction.z() != 0 ? Drawn::Direction : Drawn::Nothing;
}

bool Bsdf::sample(const BsdfView& view, float side, const Vec2f& u, BsdfSample& sample) const {
  sample.mirror = sample.subsurface = false;
  if (lambertian_) {
    sample.direction = cosine_hemisphere(u);
    sample.weight = diffuse_;
    sample.pdf = sample.direction.z() / kPi;
    sample.wide = true;
    return sample.pdf > 0;
  }
  const Drawn drawn = draw(view, side, u, sample);
  if (drawn != Drawn::Direction) return drawn == Drawn::Whole;
  const BsdfValue value = evaluate_lobes(view, sample.direction);
  if (!(value.pdf > 0)) return false;
  sample.pdf = value.pdf;
  sample.weight = value.value / value.pdf;
  return true;
}

}  // namespace softreel
