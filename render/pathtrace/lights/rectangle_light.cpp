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

// What follows up to sample(RectangleSamples&) has no branches and no arrays: a loop over it becomes vector
// instructions.

[[gnu::always_inline]] inline RectangleLight::Solid RectangleLight::solid_from(const Place& p) const {
  Solid s;
  s.x0 = -p.x - half_x_;
  s.x1 = -p.x + half_x_;
  s.y0 = -p.y - half_y_;
  s.y1 = -p.y + half_y_;
  s.z0 = -std::abs(p.height);
  s.z2 = std::max(s.z0 * s.z0, 1e-30f);  // in the plane of the lamp: nothing divided by nothing
  // Normals of the planes through the edges, and the angles between them.
  const float n0 = -s.y0 / std::sqrt(s.z2 + s.y0 * s.y0), n1 = s.x1 / std::sqrt(s.z2 + s.x1 * s.x1),
              n2 = s.y1 / std::sqrt(s.z2 + s.y1 * s.y1), n3 = -s.x0 / std::sqrt(s.z2 + s.x0 * s.x0);
  s.b0 = n0;
  s.b1 = n2;
  s.k = 2 * kPi - arc_cosine(-n2 * n3) - arc_cosine(-n3 * n0);
  s.angle = arc_cosine(-n0 * n1) + arc_cosine(-n1 * n2) - s.k;
  return s;
}

[[gnu::always_inline]] inline RectangleLight::Local RectangleLight::sample_near(const Place& p, float u,
                                                                                float v) const {
  const Solid s = solid_from(p);
  float sine = 0, cosine = 0;
  sin_cos(u * s.angle + s.k, sine, cosine);
  // The paper's f_u, c_u and x_u at once: as they stand there they take four more roots and divisions.
  const float rise = cosine * s.b0 - s.b1, z2 = s.z2;
  const float squared = std::max(rise * rise - z2 / (z2 + s.y0 * s.y0) * sine * sine, 1e-12f * sine * sine + 1e-30f);
  const float reach = -s.z0 * std::copysign(sine, sine * rise) / std::sqrt(squared);
  const float xu = std::min(std::max(reach, s.x0), s.x1);
  const float d2 = xu * xu + z2;
  const float h0 = s.y0 / std::sqrt(d2 + s.y0 * s.y0), h1 = s.y1 / std::sqrt(d2 + s.y1 * s.y1);
  const float hv = h0 + v * (h1 - h0), rest = 1 - hv * hv;
  const float yv = rest > 1e-6f ? hv * std::sqrt(d2 / std::max(rest, 1e-6f)) : s.y1;
  return {xu, yv, -p.height, std::sqrt(d2 + yv * yv), s.angle > 0 ? 1 / s.angle : 0.0f};
}

[[gnu::always_inline]] inline RectangleLight::Local RectangleLight::sample_far(const Place& p, float u, float v) const {
  const float to_x = (2 * u - 1) * half_x_ - p.x, to_y = (2 * v - 1) * half_y_ - p.y;
  const float squared = to_x * to_x + to_y * to_y + p.height * p.height, distance = std::sqrt(squared);
  return {to_x, to_y, -p.height, distance, squared * distance / (area_ * p.height)};
}

/// Direction and distance in the world's axes.
[[gnu::always_inline]] inline RectangleLight::Local RectangleLight::to_world(const Local& at) const {
  const float scale = 1 / at.distance;
  return {(at.x * x_[0] + at.y * y_[0] + at.z * normal_[0]) * scale,
          (at.x * x_[1] + at.y * y_[1] + at.z * normal_[1]) * scale,
          (at.x * x_[2] + at.y * y_[2] + at.z * normal_[2]) * scale, at.distance, at.pdf};
}

[[gnu::always_inline]] inline RectangleLight::Place RectangleLight::place_of(float x, float y, float z) const {
  const float px = x - center_[0], py = y - center_[1], pz = z - center_[2];
  return {px * x_[0] + py * x_[1] + pz * x_[2], px * y_[0] + py * y_[1] + pz * y_[2],
          px * normal_[0] + py * normal_[1] + pz * normal_[2]};
}

void RectangleLight::sample(RectangleSamples& samples) const {
  const RectangleLight light = *this;  // else the compiler thinks that it may change with what is stored
  // Whole vectors; what lies beyond the last point is of no interest.
  constexpr std::size_t kVector = 8;
  static_assert(RectangleSamples::kMost % kVector == 0);
  const std::size_t count = (samples.count_ + kVector - 1) / kVector * kVector;
  for (std::size_t n = 0; n < count; ++n) {
    const Place p = light.place_of(samples.p_[0][n], samples.p_[1][n], samples.p_[2][n]);
    const float u = samples.u_[n], v = samples.v_[n];
    const Local near = light.sample_near(p, u, v), far = light.sample_far(p, u, v);
    const bool is_far = light.is_far(p);
    Local at;
    at.x = is_far ? far.x : near.x;
    at.y = is_far ? far.y : near.y;
    at.z = -p.height;
    at.distance = is_far ? far.distance : near.distance;
    const float pdf = is_far ? far.pdf : near.pdf;
    at.pdf = p.height > 0 ? pdf : 0.0f;
    at = light.to_world(at);
    samples.direction_[0][n] = at.x;
    samples.direction_[1][n] = at.y;
    samples.direction_[2][n] = at.z;
    samples.distance_[n] = at.distance;
    samples.pdf_[n] = at.pdf;
  }
}

bool RectangleLight::sample(const Vec3f& p, const Vec2f& u, LightSample& sample) const {
  const Place place = place_of(p.x(), p.y(), p.z());
  if (!(place.height > 0)) return false;
  const Local at = to_world(is_far(place) ? sample_far(place, u.x(), u.y()) : sample_near(place, u.x(), u.y()));
  sample = {Vec3f(at.x, at.y, at.z), at.distance, radiance_, at.pdf};
  return sample.pdf > 0;
}

float RectangleLight::pdf(const Vec3f& origin, const Vec3f& direction, float distance) const {
  const Place place = place_of(origin.x(), origin.y(), origin.z());
  if (is_far(place)) return distance * distance / (area_ * -direction.dot(normal_));
  const float angle = solid_from(place).angle;
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
