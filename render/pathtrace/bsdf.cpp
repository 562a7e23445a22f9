#include "render/pathtrace/bsdf.h"

#include "render/pathtrace/sampling.h"

namespace softreel {

namespace {

/// Lobes of this alpha (roughness 0.32) and more are wide.
constexpr float kWideAlpha = 0.1f;

/// Mean of part(h) over the normals h visible from a cosine; part gives two numbers.
///
/// GGX has heavy tails, which lie at the rim of the disk that visible normals come from: rings are spaced evenly in
/// v = (1 - r^2)^(1/4), where they are wide enough for few points: 2 r dr = 4 v^3 dv. Half the circle mirrors the
/// other.
template <typename Part>
Vec2f mean_over_normals(float cosine, float alpha, const Part& part) {
  constexpr int kRings = 32, kAngles = 24;
  const float mu = std::max(cosine, 1e-4f);
  const Vec3f o(std::sqrt(std::max(0.0f, 1 - mu * mu)), 0, mu);
  Vec2f sum = Vec2f::Zero();
  for (int ring = 0; ring < kRings; ++ring) {
    const float v = (static_cast<float>(ring) + 0.5f) / kRings, v2 = v * v;
    const float radius = std::sqrt(1 - v2 * v2);
    for (int k = 0; k < kAngles; ++k) {
      const float angle = kPi * ((static_cast<float>(k) + 0.5f) / kAngles - 0.5f);
      const Vec3f h = visible_normal(o, alpha, radius * Vec2f(std::cos(angle), std::sin(angle)));
      sum += 4 * v2 * v * part(o, h);
    }
  }
  return sum / (kRings * kAngles);
}

/// Sampling weight G2 / G1 of a direction with cosine `cos_i`, which may be on either side.
float shadowing_weight(const Vec3f& o, float cos_i, float alpha) {
  return ggx_shadowing(o.z(), std::abs(cos_i), alpha) / ggx_masking(o.z(), alpha);
}

/// What a reflection returns: of reflectance 1 - (1 - c)^5, and of (1 - c)^5.
Vec2f reflection_albedo(float cosine, float alpha) {
  return mean_over_normals(cosine, alpha, [alpha](const Vec3f& o, const Vec3f& h) -> Vec2f {
    const float cos_d = o.dot(h), cos_i = 2 * cos_d * h.z() - o.z();
    if (cos_i <= 0) return Vec2f::Zero();
    const float rim = schlick_weight(cos_d);
    return shadowing_weight(o, cos_i, alpha) * Vec2f(1 - rim, rim);
  });
}

/// What rough glass reflects and lets through.
Vec2f glass_albedo(float cosine, float alpha, float eta) {
  return mean_over_normals(cosine, alpha, [alpha, eta](const Vec3f& o, const Vec3f& h) -> Vec2f {
    const float cos_d = o.dot(h), cos_i = 2 * cos_d * h.z() - o.z();
    const float fresnel = fresnel_dielectric(cos_d, eta);
    Vec2f part = Vec2f::Zero();
    if (cos_i > 0) part.x() = fresnel * shadowing_weight(o, cos_i, alpha);
    Vec3f t;
    if (refract(o, h, eta, t) && t.z() < 0) part.y() = (1 - fresnel) * shadowing_weight(o, t.z(), alpha);
    return part;
  });
}

}  // namespace

template <typename At>
void AlbedoTable::fill(const At& albedo_at) {
  for (int k = 0; k <= kIntervals; ++k) {
    const float s = static_cast<float>(k) / kIntervals;
    knots_[static_cast<std::size_t>(k)] = albedo_at(s * s);
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

AlbedoTable AlbedoTable::of_reflection(float alpha) {
  AlbedoTable table;
  if (alpha < kSmoothAlpha)
    table.fill([](float mu) { return Vec2f(1 - schlick_weight(mu), schlick_weight(mu)); });
  else
    table.fill([alpha](float mu) { return reflection_albedo(mu, alpha); });
  return table;
}

AlbedoTable AlbedoTable::of_glass(float alpha, float eta) {
  AlbedoTable table;
  if (alpha < kSmoothAlpha)
    table.fill([eta](float mu) { return Vec2f(fresnel_dielectric(mu, eta), 1 - fresnel_dielectric(mu, eta)); });
  else
    table.fill([alpha, eta](float mu) { return glass_albedo(mu, alpha, eta); });
  return table;
}

Vec2f AlbedoTable::at(float cosine) const {
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
      albedo_(appearance.base_color) {
  const float metal = appearance.metallic;
  glass_ = (1 - metal) * appearance.transmission;
  const float base = (1 - metal) * (1 - appearance.transmission);
  coat_f0_ = 0.08f * appearance.specular;
  const bool coated = coat_f0_ > 0;
  const Vec3f metal_color = appearance.metal_color.value_or(appearance.base_color);
  f0_ = metal * metal_color + Vec3f::Constant(base * coat_f0_);
  f90_ = Vec3f::Constant(metal + (coated ? base : 0.0f));
  diffuse_ = base * appearance.base_color;
  lambertian_ = !coated && metal == 0 && glass_ == 0;
  if (!lambertian_) ggx_albedo_ = AlbedoTable::of_reflection(alpha_);
  if (glass_ > 0) {
    glass_outside_ = AlbedoTable::of_glass(alpha_, ior_);
    glass_inside_ = AlbedoTable::of_glass(alpha_, 1 / ior_);
  }
  const Vec2f mean = ggx_albedo_.mean();
  if (coated) coat_scale_ = 1 / (1 - (coat_f0_ * mean.x() + mean.y()));
  if (metal > 0) {
    // Kulla and Conty: light that leaves after several reflections, coloured once more by each.
    const float once = mean.x() + mean.y();
    const Vec3f f_mean = metal_color + (Vec3f::Ones() - metal_color) / 21;
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
  sum.value += Vec3f::Constant(glass_ * pdf * shadowing_weight(o, i.z(), alpha_) / kept);
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
  if (glass_ > 0 && !mirror_ && i.z() != 0) add_glass(o, i, inside, p.glass, sum);
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
  sample.wide = alpha_ >= kWideAlpha;
  if (lambertian_) {
    sample.direction = cosine_hemisphere(u);
    sample.weight = diffuse_;
    sample.pdf = sample.direction.z() / kPi;
    sample.wide = true;
    return sample.pdf > 0;
  }
  const Shares p = shares(ggx_albedo_.at(o.z()));
  if (lobe < p.cosine) {
    sample.direction = cosine_hemisphere(u);
    sample.wide = true;
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
