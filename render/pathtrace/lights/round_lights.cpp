#include "render/pathtrace/lights/round_lights.h"

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {

DiskLight::DiskLight(const AreaLight& light)
    : center_(light.center),
      u_(light.u),
      v_(light.v),
      area_(kPi * light.u.norm() * light.v.norm()),
      radius2_(std::max(light.u.squaredNorm(), light.v.squaredNorm())),
      radiance_(light.radiance),
      visible_(light.visible),
      luminance_(luminance(light.radiance)) {
  if (!(area_ > 0) || !std::isfinite(area_) || std::abs(u_.dot(v_)) > 1e-3f * u_.norm() * v_.norm())
    throw input_error(
        fmt::format("A disk's half axes u = ({}, {}, {}), v = ({}, {}, {}) span no disk.\n"
                    "  Accepted: two perpendicular vectors of lengths above 0, m. Correct u or v of the light.",
                    u_.x(), u_.y(), u_.z(), v_.x(), v_.y(), v_.z()));
  normal_ = u_.cross(v_).normalized();
}

bool DiskLight::sample(const Vec3f& p, const Vec2f& u, LightSample& sample) const {
  const float height = (p - center_).dot(normal_);
  if (height <= 0) return false;
  const Vec2f place = concentric_disk(u);
  const Vec3f to = center_ + place.x() * u_ + place.y() * v_ - p;
  const float squared = to.squaredNorm();
  sample.distance = std::sqrt(squared);
  sample.direction = to / sample.distance;
  sample.radiance = radiance_;
  sample.pdf = squared * sample.distance / (area_ * height);
  return true;
}

float DiskLight::pdf(const Vec3f& /*origin*/, const Vec3f& direction, float distance) const {
  return distance * distance / (area_ * -direction.dot(normal_));
}

bool DiskLight::intersect(const Vec3f& origin, const Vec3f& direction, float max_distance, float& distance) const {
  Vec3f at;
  float t = 0;
  if (!flat().meets_plane(origin, direction, max_distance, t, at)) return false;
  const float x = at.dot(u_) / u_.squaredNorm(), y = at.dot(v_) / v_.squaredNorm();
  if (x * x + y * y > 1) return false;
  distance = t;
  return true;
}

float DiskLight::importance(const Vec3f& p) const {
  return flat().importance(p, luminance_);
}

bool DiskLight::below(const Vec3f& p, const Vec3f& normal) const {
  const float x = u_.dot(normal), y = v_.dot(normal);
  return (center_ - p).dot(normal) + std::sqrt(x * x + y * y) <= 0;
}

// ----------------------------------------------------------------------------------------------------------------------

SphereLight::SphereLight(const AreaLight& light)
    : center_(light.center),
      radius_(light.u.norm()),
      radiance_(light.radiance),
      visible_(light.visible),
      luminance_(luminance(light.radiance)) {
  if (!(radius_ > 0) || !std::isfinite(radius_))
    throw input_error(
        fmt::format("A sphere of radius {} m is no lamp.\n"
                    "  Accepted: a finite length above 0. Correct the size of the light.",
                    radius_));
}

float SphereLight::one_minus_cos(const Vec3f& p) const {
  const float sine2 = radius_ * radius_ / (p - center_).squaredNorm();
  return sine2 < 1 ? sine2 / (1 + std::sqrt(1 - sine2)) : 0.0f;
}

bool SphereLight::sample(const Vec3f& p, const Vec2f& u, LightSample& sample) const {
  const float cap = one_minus_cos(p);
  if (cap <= 0) return false;
  const Vec3f to = center_ - p;
  const float distance = to.norm();
  const Vec3f local = uniform_cone(u, cap);
  sample.direction = ShadingFrame(to / distance).to_world(local);
  // Along the ray to the foot of the centre, less half the chord; at the rim rounding may leave nothing of it.
  const float sine2 = std::max(0.0f, 1 - local.z() * local.z());
  const float half_chord = std::sqrt(std::max(0.0f, radius_ * radius_ - distance * distance * sine2));
  sample.distance = distance * local.z() - half_chord;
  sample.radiance = radiance_;
  sample.pdf = 1 / (2 * kPi * cap);
  return true;
}

float SphereLight::pdf(const Vec3f& origin, const Vec3f& /*direction*/, float /*distance*/) const {
  const float cap = one_minus_cos(origin);
  return cap > 0 ? 1 / (2 * kPi * cap) : 0.0f;
}

bool SphereLight::intersect(const Vec3f& origin, const Vec3f& direction, float max_distance, float& distance) const {
  const Vec3f to = center_ - origin;
  const float along = to.dot(direction);
  if (along <= 0 || to.squaredNorm() <= radius_ * radius_) return false;
  const float off2 = (to - along * direction).squaredNorm();
  if (off2 > radius_ * radius_) return false;
  const float t = along - std::sqrt(radius_ * radius_ - off2);
  if (!(t > 0 && t < max_distance)) return false;
  distance = t;
  return true;
}

float SphereLight::importance(const Vec3f& p) const {
  const float squared = (p - center_).squaredNorm(), radius2 = radius_ * radius_;
  return squared > radius2 ? luminance_ * kPi * radius2 / squared : 0.0f;
}

bool SphereLight::below(const Vec3f& p, const Vec3f& normal) const {
  return (center_ - p).dot(normal) + radius_ <= 0;
}

}  // namespace softreel
