#include "render/pathtrace/materials/sheen.h"

#include <cmath>

#include "core/base/check.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {

namespace {

/// Integral of value(o, i) over the hemisphere, by midpoints. Rings are spaced evenly in the root of the cosine: the
/// lobe is strongest at grazing angles. Half the circle mirrors the other.
float integrated(const Sheen& sheen, float cosine) {
  constexpr int kRings = 64, kAngles = 64;
  const float mu = std::max(cosine, 1e-4f);
  const Vec3f o(std::sqrt(1 - mu * mu), 0, mu);
  double sum = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const float v = (static_cast<float>(ring) + 0.5f) / kRings, z = v * v;
    const float across = std::sqrt(1 - z * z);
    for (int k = 0; k < kAngles; ++k) {
      const float angle = kPi * (static_cast<float>(k) + 0.5f) / kAngles;
      const Vec3f i(across * std::cos(angle), across * std::sin(angle), z);
      sum += static_cast<double>(2 * v * sheen.value(o, i));
    }
  }
  return static_cast<float>(sum * 2 * static_cast<double>(kPi) / (kRings * kAngles));
}

}  // namespace

Sheen::Sheen(float roughness) : exponent_(1 / roughness) {
  CHECK(roughness >= static_cast<float>(kLeastRoughness));
  CHECK(roughness <= 1);
  // Table 1 of the paper holds L for roughness 0 and 1.
  const float t = (1 - roughness) * (1 - roughness);
  const auto between = [t](float fine, float coarse) { return t * fine + (1 - t) * coarse; };
  a_ = between(25.3245f, 21.5473f);
  b_ = between(3.32435f, 3.82987f);
  c_ = between(0.16801f, 0.19823f);
  d_ = between(-1.27393f, -1.97760f);
  e_ = between(-4.85967f, -4.32054f);
  half_ = curve(0.5f);
  albedo_ = AlbedoTable::of([this](float mu) { return Vec2f(integrated(*this, mu), 0); });
}

float Sheen::curve(float x) const {
  return a_ / (1 + b_ * std::pow(x, c_)) + d_ * x + e_;
}

float Sheen::lambda(float cosine) const {
  return cosine < 0.5f ? std::exp(curve(cosine)) : std::exp(2 * half_ - curve(std::max(0.0f, 1 - cosine)));
}

float Sheen::value(const Vec3f& o, const Vec3f& i) const {
  if (!(o.z() > 0) || !(i.z() > 0)) return 0;
  const float cos_h = (o.z() + i.z()) / (o + i).norm();
  const float sine = std::sqrt(std::max(0.0f, 1 - cos_h * cos_h));
  const float distribution = (2 + exponent_) * std::pow(sine, exponent_) / (2 * kPi);
  return distribution / (4 * o.z() * (1 + lambda(o.z()) + lambda(i.z())));
}

}  // namespace softreel
