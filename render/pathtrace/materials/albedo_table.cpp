#include "render/pathtrace/materials/albedo_table.h"

#include "render/pathtrace/materials/microfacet.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {

namespace {

/// Mean of part(h) over the normals h visible from a cosine; part gives two numbers.
///
/// GGX has heavy tails, which lie at the rim of the disk that visible normals come from: rings are spaced evenly in
/// v = (1 - r^2)^(1/4), where they are wide enough for few points: 2 r dr = 4 v^3 dv. Half the circle mirrors the
/// other. turn: of each ring's points against those of the one before, in steps between them.
template <int kRings, int kAngles, typename Part>
Vec2f mean_over_normals(float cosine, float alpha, float turn, const Part& part) {
  const float mu = std::max(cosine, 1e-4f);
  const Vec3f o(std::sqrt(std::max(0.0f, 1 - mu * mu)), 0, mu);
  Vec2f sum = Vec2f::Zero();
  for (int ring = 0; ring < kRings; ++ring) {
    const float v = (static_cast<float>(ring) + 0.5f) / kRings, v2 = v * v;
    const float radius = std::sqrt(1 - v2 * v2), place = std::fmod(0.5f + static_cast<float>(ring) * turn, 1.0f);
    for (int k = 0; k < kAngles; ++k) {
      const float angle = kPi * ((static_cast<float>(k) + place) / kAngles - 0.5f);
      const Vec3f h = visible_normal(o, alpha, radius * Vec2f(std::cos(angle), std::sin(angle)));
      sum += 4 * v2 * v * part(o, h);
    }
  }
  return sum / (kRings * kAngles);
}

/// What a reflection returns: of reflectance 1 - (1 - c)^5, and of (1 - c)^5.
Vec2f reflection_albedo(float cosine, float alpha, const AlbedoTable::Passed& passed) {
  return mean_over_normals<32, 24>(cosine, alpha, 0, [&](const Vec3f& o, const Vec3f& h) -> Vec2f {
    const float cos_d = o.dot(h), cos_i = 2 * cos_d * h.z() - o.z();
    if (cos_i <= 0) return Vec2f::Zero();
    const float rim = schlick_weight(cos_d);
    const float seen = passed ? std::min(passed(o.z()), passed(cos_i)) : 1.0f;
    return seen * shadowing_weight(o, cos_i, alpha) * Vec2f(1 - rim, rim);
  });
}

/// What rough glass reflects and lets through. Light inside meets it many times, which adds up the errors of the table:
/// many rings, each turned by the golden ratio of a step, so that the edge of total reflection falls between points
/// anywhere.
Vec2f glass_albedo(float cosine, float alpha, float eta) {
  constexpr float kGolden = 0.618034f;
  return mean_over_normals<256, 12>(cosine, alpha, kGolden, [&](const Vec3f& o, const Vec3f& h) -> Vec2f {
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

AlbedoTable AlbedoTable::of(const std::function<Vec2f(float)>& albedo_at) {
  AlbedoTable table;
  for (int k = 0; k <= kIntervals; ++k) {
    const float s = static_cast<float>(k) / kIntervals;
    table.knots_[static_cast<std::size_t>(k)] = albedo_at(s * s);
  }
  // at() is linear in s = sqrt(mu): the mean of 2 mu dmu = 4 s^3 ds by midpoints of a finer grid.
  constexpr int kSteps = 16 * kIntervals;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int k = 0; k < kSteps; ++k) {
    const double s = (k + 0.5) / kSteps;
    sum += 4 * s * s * s * table.at(static_cast<float>(s * s)).cast<double>();
  }
  table.mean_ = (sum / kSteps).cast<float>();
  return table;
}

AlbedoTable AlbedoTable::of_reflection(float alpha, const Passed& passed) {
  if (alpha >= kSmoothAlpha) return of([&](float mu) { return reflection_albedo(mu, alpha, passed); });
  return of([&](float mu) {
    const float rim = schlick_weight(mu);
    return Vec2f(Vec2f(1 - rim, rim) * (passed ? passed(mu) : 1.0f));
  });
}

AlbedoTable AlbedoTable::of_glass(float alpha, float eta) {
  if (alpha >= kSmoothAlpha) return of([alpha, eta](float mu) { return glass_albedo(mu, alpha, eta); });
  return of([eta](float mu) {
    const float reflected = fresnel_dielectric(mu, eta);
    return Vec2f(reflected, 1 - reflected);
  });
}

AlbedoTable AlbedoTable::between(const AlbedoTable& a, const AlbedoTable& b, float share) {
  AlbedoTable table;
  for (std::size_t k = 0; k < a.knots_.size(); ++k) table.knots_[k] = a.knots_[k] + share * (b.knots_[k] - a.knots_[k]);
  table.mean_ = a.mean_ + share * (b.mean_ - a.mean_);
  return table;
}

}  // namespace softreel
