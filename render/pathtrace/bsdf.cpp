#include "render/pathtrace/bsdf.h"

#include "render/pathtrace/sampling.h"

namespace softreel {

namespace {

/// Directional albedo at one cosine: the mean of the sampling weight G2 / G1 over an even grid of visible normals.
Vec2f albedo_at(float cosine, float alpha) {
  constexpr int kGrid = 24;
  const float mu = std::max(cosine, 1e-4f);
  const Vec3f o(std::sqrt(std::max(0.0f, 1 - mu * mu)), 0, mu);
  Vec2f sum = Vec2f::Zero();
  for (int a = 0; a < kGrid; ++a)
    for (int b = 0; b < kGrid; ++b) {
      const Vec2f u((static_cast<float>(a) + 0.5f) / kGrid, (static_cast<float>(b) + 0.5f) / kGrid);
      const Vec3f h = sample_visible_normal(o, alpha, u);
      const float cos_d = o.dot(h);
      const Vec3f i = 2 * cos_d * h - o;
      if (i.z() <= 0) continue;
      const float weight = ggx_shadowing(mu, i.z(), alpha) / ggx_masking(mu, alpha);
      const float rim = schlick_weight(cos_d);
      sum += weight * Vec2f(1 - rim, rim);
    }
  return sum / (kGrid * kGrid);
}

}  // namespace

GgxAlbedo::GgxAlbedo(float alpha) {
  for (int k = 0; k <= kIntervals; ++k) {
    const float s = static_cast<float>(k) / kIntervals;
    if (alpha < kSmoothAlpha) {
      const float rim = schlick_weight(s * s);
      knots_[static_cast<std::size_t>(k)] = Vec2f(1 - rim, rim);
    } else {
      knots_[static_cast<std::size_t>(k)] = albedo_at(s * s, alpha);
    }
  }
  // at() is linear in s = sqrt(mu): the mean of 2 mu dmu = 4 s^3 ds by midpoints of a finer grid.
  constexpr int kSteps = 16 * kIntervals;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int k = 0; k < kSteps; ++k) {
    const double s = (k + 0.5) / kSteps;
    sum += 4 * s * s * s * at(static_cast<float>(s * s)).cast<double>();
  }
  mean_ = (sum / kSteps).cast<float>();
}

Vec2f GgxAlbedo::at(float cosine) const {
  const float s = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * kIntervals;
  const int k = std::min(static_cast<int>(s), kIntervals - 1);
  const float t = s - static_cast<float>(k);
  const auto i = static_cast<std::size_t>(k);
  return (1 - t) * knots_[i] + t * knots_[i + 1];
}

Bsdf::Bsdf(const Appearance& appearance)
    : alpha_(appearance.roughness * appearance.roughness),
      mirror_(alpha_ < kSmoothAlpha),
      ior_(appearance.ior),
      absorption_(appearance.absorption),
      emission_(appearance.emission),
      albedo_(appearance.base_color),
      ggx_albedo_(alpha_) {
  const float metal = appearance.metallic;
  glass_ = (1 - metal) * appearance.transmission;
  const float base = (1 - metal) * (1 - appearance.transmission);
  coat_f0_ = 0.08f * appearance.specular;
  const bool coated = coat_f0_ > 0;
  f0_ = metal * appearance.base_color + Vec3f::Constant(base * coat_f0_);
  f90_ = Vec3f::Constant(metal + (coated ? base : 0.0f));
  diffuse_ = base * appearance.base_color;
  const Vec2f mean = ggx_albedo_.mean();
  if (coated) coat_scale_ = 1 / (1 - (coat_f0_ * mean.x() + mean.y()));
  lambertian_ = !coated && metal == 0 && glass_ == 0;
  if (metal > 0) {
    // Kulla and Conty: light that leaves after several reflections, coloured once more by each.
    const float once = mean.x() + mean.y();
    const Vec3f f_mean = appearance.base_color + (Vec3f::Ones() - appearance.base_color) / 21;
    const Vec3f f_return = (f_mean.array().square() * once / (1 - f_mean.array() * (1 - once))).matrix();
    if (once < 1 - 1e-5f) metal_return_ = metal / (1 - once) * f_return;
  }
  diffuse_or_metal_ = diffuse_.maxCoeff() > 0 || metal_return_.maxCoeff() > 0;
}

Bsdf::Shares Bsdf::shares(const Vec2f& e) const {
  const float reflected = (f0_ * e.x() + f90_ * e.y()).maxCoeff();
  const float under_coat = diffuse_.maxCoeff() * (1 - (coat_f0_ * e.x() + (coat_f0_ > 0 ? e.y() : 0.0f)));
  const float returned = metal_return_.maxCoeff() * (1 - (e.x() + e.y())) * (1 - ggx_albedo_.mean().sum());
  const float cosine = diffuse_or_metal_ ? under_coat + std::max(0.0f, returned) : 0.0f;
  const float total = reflected + cosine + glass_;
  if (!(total > 0)) return {};
  return {reflected / total, cosine / total, glass_ / total};
}

Vec3f Bsdf::cosine_lobe(float cos_o, float cos_i) const {
  constexpr float kInvPi = 1 / kPi;
  if (lambertian_) return diffuse_ * (cos_i * kInvPi);
  const Vec2f eo = ggx_albedo_.at(cos_o), ei = ggx_albedo_.at(cos_i);
  Vec3f sum = metal_return_ * ((1 - eo.sum()) * (1 - ei.sum()));
  if (coat_f0_ > 0)
    sum += diffuse_ * (coat_scale_ * (1 - (coat_f0_ * eo.x() + eo.y())) * (1 - (coat_f0_ * ei.x() + ei.y())));
  else
    sum += diffuse_;
  return sum * (cos_i * kInvPi);
}

void Bsdf::add_reflection(const Vec3f& o, const Vec3f& i, float share, BsdfValue& sum) const {
  const Vec3f h = (o + i).normalized();
  const float cos_d = o.dot(h);
  const float distribution = ggx_distribution(h.z(), alpha_);
  const float lambda_o = ggx_lambda(o.z(), alpha_), lambda_i = ggx_lambda(i.z(), alpha_);
  const float common = distribution / (4 * o.z());
  sum.value += reflectance(cos_d) * (common / (1 + lambda_o + lambda_i));
  sum.pdf += share * common / (1 + lambda_o);
}

void Bsdf::add_glass(const Vec3f& o, const Vec3f& i, float eta, float share, BsdfValue& sum) const {
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
  const float shadowing = ggx_shadowing(o.z(), std::abs(i.z()), alpha_) / ggx_masking(o.z(), alpha_);
  const float denominator = i_h + o_h / eta;
  const float pdf =
      reflected ? fresnel * visible / (4 * o_h) : (1 - fresnel) * visible * std::abs(i_h) / (denominator * denominator);
  sum.value += Vec3f::Constant(glass_ * pdf * shadowing);
  sum.pdf += share * pdf;
}

BsdfValue Bsdf::evaluate(const Vec3f& o, const Vec3f& i, bool inside) const {
  BsdfValue sum;
  if (lambertian_) {
    if (i.z() <= 0) return sum;
    return {diffuse_ * (i.z() / kPi), i.z() / kPi};
  }
  const Shares p = shares(ggx_albedo_.at(o.z()));
  if (i.z() > 0) {
    if (diffuse_or_metal_) {
      sum.value += cosine_lobe(o.z(), i.z());
      sum.pdf += p.cosine * i.z() / kPi;
    }
    if (!mirror_ && p.reflection > 0) add_reflection(o, i, p.reflection, sum);
  }
  if (glass_ > 0 && !mirror_ && i.z() != 0) add_glass(o, i, inside ? 1 / ior_ : ior_, p.glass, sum);
  return sum;
}

bool Bsdf::sample_mirror_glass(const Vec3f& o, float u, float eta, BsdfSample& sample) const {
  sample.mirror = true;
  sample.weight = Vec3f::Ones();
  if (u < fresnel_dielectric(o.z(), eta)) {
    sample.direction = Vec3f(-o.x(), -o.y(), o.z());
    return true;
  }
  return refract(o, Vec3f(0, 0, 1), eta, sample.direction);
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

bool Bsdf::sample(const Vec3f& o, float lobe, const Vec2f& u, bool inside, BsdfSample& sample) const {
  sample.mirror = false;
  if (lambertian_) {
    sample.direction = cosine_hemisphere(u);
    sample.weight = diffuse_;
    sample.pdf = sample.direction.z() / kPi;
    return sample.pdf > 0;
  }
  const Shares p = shares(ggx_albedo_.at(o.z()));
  if (lobe < p.cosine) {
    sample.direction = cosine_hemisphere(u);
  } else if (lobe < p.cosine + p.reflection) {
    if (mirror_) {
      sample.direction = Vec3f(-o.x(), -o.y(), o.z());
      sample.weight = reflectance(o.z()) / p.reflection;
      sample.mirror = true;
      sample.pdf = 0;
      return true;
    }
    const Vec3f h = sample_visible_normal(o, alpha_, u);
    sample.direction = 2 * o.dot(h) * h - o;
    if (sample.direction.z() <= 0) return false;
  } else if (p.glass > 0) {
    const float eta = inside ? 1 / ior_ : ior_;
    const float side = std::clamp((lobe - p.cosine - p.reflection) / p.glass, 0.0f, 0x1.fffffep-1f);
    if (mirror_) {
      if (!sample_mirror_glass(o, side, eta, sample)) return false;
      sample.weight = Vec3f::Constant(glass_ / p.glass);
      sample.pdf = 0;
      return true;
    }
    sample.direction = sample_rough_glass(o, side, u, eta);
    if (sample.direction.z() == 0) return false;
  } else {
    return false;
  }
  const BsdfValue value = evaluate(o, sample.direction, inside);
  if (!(value.pdf > 0)) return false;
  sample.pdf = value.pdf;
  sample.weight = value.value / value.pdf;
  return true;
}

}  // namespace softreel
