#include "render/pathtrace/lights/rectangle_light.h"

#include <array>

#include <fmt/format.h>

#include "core/base/error.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {

bool FlatLamp::meets_plane(const Vec3f& origin, const Vec3f& direction, float max_distance, float& distance,
                           Vec3f& place) const {
  const float cosine = -direction.dot(normal);
  if (cosine <= 0) return false;
  const Vec3f d = center - origin;
  const float t = -d.dot(normal) / cosine;
  if (!(t > 0 && t < max_distance)) return false;
  place = t * direction - d;
  distance = t;
  return true;
}

float FlatLamp::importance(const Vec3f& p, float luminance) const {
  const Vec3f d = p - center;
  const float height = d.dot(normal);
  if (height <= 0) return 0;
  const float squared = d.squaredNorm() + squared_radius;
  return luminance * area * (height + 0.1f * std::sqrt(squared_radius)) / (squared * std::sqrt(squared));
}

RectangleLight::RectangleLight(const AreaLight& light)
    : center_(light.center),
      half_x_(light.u.norm()),
      half_y_(light.v.norm()),
      radiance_(light.radiance),
      visible_(light.visible),
      luminance_(luminance(light.radiance)) {
  const bool sized = half_x_ > 0 && half_y_ > 0 && std::isfinite(half_x_ * half_y_);
  if (!sized || std::abs(light.u.dot(light.v)) > 1e-3f * half_x_ * half_y_)
    throw input_error(
        fmt::format("An area light's half edges u = ({}, {}, {}), v = ({}, {}, {}) span no rectangle.\n"
                    "  Accepted: two perpendicular vectors of lengths above 0, m. Correct u or v of the light.",
                    light.u.x(), light.u.y(), light.u.z(), light.v.x(), light.v.y(), light.v.z()));
  x_ = light.u / half_x_;
  normal_ = x_.cross(light.v / half_y_).normalized();
  y_ = normal_.cross(x_);
  area_ = 4 * half_x_ * half_y_;
  radius2_ = half_x_ * half_x_ + half_y_ * half_y_;
}

RectangleLight::Solid RectangleLight::solid_from(const Vec3f& p) const {
  Solid s;
  const Vec3f d = center_ - p;
  const float x = d.dot(x_), y = d.dot(y_);
  s.x0 = x - half_x_;
  s.x1 = x + half_x_;
  s.y0 = y - half_y_;
  s.y1 = y + half_y_;
  s.z0 = -std::abs(d.dot(normal_));
  const float z2 = s.z0 * s.z0;
  // In loops over the four edges, which become vector instructions. n: of the planes through the edges.
  std::array<float, 4> n{-s.y0, s.x1, s.y1, -s.x0}, angles{};
  for (float& side : n) side /= std::sqrt(z2 + side * side);
  const std::array<float, 4> next{n[1], n[2], n[3], n[0]};
  for (std::size_t k = 0; k < 4; ++k) angles[k] = arc_cosine(-n[k] * next[k]);
  s.b0 = n[0];
  s.b1 = n[2];
  s.k = 2 * kPi - angles[2] - angles[3];
  s.angle = angles[0] + angles[1] - s.k;
  return s;
}

bool RectangleLight::sample(const Vec3f& p, const Vec2f& u, LightSample& sample) const {
  const float height = (p - center_).dot(normal_);
  if (height <= 0) return false;
  sample.radiance = radiance_;
  if (is_far(p)) {
    const Vec3f to = center_ + ((2 * u.x() - 1) * half_x_) * x_ + ((2 * u.y() - 1) * half_y_) * y_ - p;
    const float squared = to.squaredNorm();
    sample.distance = std::sqrt(squared);
    sample.direction = to / sample.distance;
    sample.pdf = squared * sample.distance / (area_ * height);
    return true;
  }
  const Solid s = solid_from(p);
  if (!(s.angle > 0)) return false;
  const float au = u.x() * s.angle + s.k;
  float sine = 0, cosine = 0;
  sin_cos(au, sine, cosine);
  // The paper's f_u, c_u and x_u at once: as they stand there they take four more roots and divisions.
  const float rise = cosine * s.b0 - s.b1, z2 = s.z0 * s.z0;
  const float squared = std::max(rise * rise - z2 / (z2 + s.y0 * s.y0) * sine * sine, 1e-12f * sine * sine + 1e-30f);
  const float reach = -s.z0 * std::copysign(sine, sine * rise) / std::sqrt(squared);
  const float xu = std::clamp(reach, s.x0, s.x1);
  const float d2 = xu * xu + z2;
  const float h0 = s.y0 / std::sqrt(d2 + s.y0 * s.y0), h1 = s.y1 / std::sqrt(d2 + s.y1 * s.y1);
  const float hv = h0 + u.y() * (h1 - h0);
  const float yv = hv * hv < 1 - 1e-6f ? hv * std::sqrt(d2 / (1 - hv * hv)) : s.y1;
  const Vec3f to = xu * x_ + yv * y_ - height * normal_;
  sample.distance = std::sqrt(d2 + yv * yv);
  sample.direction = to * (1 / sample.distance);
  sample.pdf = 1 / s.angle;
  return true;
}

float RectangleLight::pdf(const Vec3f& origin, const Vec3f& direction, float distance) const {
  if (is_far(origin)) return distance * distance / (area_ * -direction.dot(normal_));
  const float angle = solid_from(origin).angle;
  return angle > 0 ? 1 / angle : 0.0f;
}

bool RectangleLight::intersect(const Vec3f& origin, const Vec3f& direction, float max_distance, float& distance) const {
  Vec3f at;
  float t = 0;
  if (!flat().meets_plane(origin, direction, max_distance, t, at)) return false;
  if (std::abs(at.dot(x_)) > half_x_ || std::abs(at.dot(y_)) > half_y_) return false;
  distance = t;
  return true;
}

float RectangleLight::importance(const Vec3f& p) const {
  return flat().importance(p, luminance_);
}

bool RectangleLight::below(const Vec3f& p, const Vec3f& normal) const {
  const float reach = half_x_ * std::abs(x_.dot(normal)) + half_y_ * std::abs(y_.dot(normal));
  return (center_ - p).dot(normal) + reach <= 0;
}

}  // namespace softreel
