#include "render/pathtrace/light_set.h"

#include <limits>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {

LightSet::Sun LightSet::make_sun(const SunLight& light) {
  const float length = light.direction.norm();
  if (!(length > 0) || !(light.angular_diameter >= 0) || !(light.angular_diameter < kPi))
    throw input_error(
        fmt::format("A sun with direction ({}, {}, {}) and angular diameter {} rad does not shine.\n"
                    "  Accepted: any direction of a length above 0; 0 to 3.14 rad. Correct the sun.",
                    light.direction.x(), light.direction.y(), light.direction.z(), light.angular_diameter));
  Sun sun;
  sun.towards = -light.direction / length;
  sun.frame = ShadingFrame(sun.towards);
  const float sine = std::sin(0.5f * light.angular_diameter);
  const float quarter_sine = std::sin(0.25f * light.angular_diameter);
  sun.one_minus_cos = 2 * quarter_sine * quarter_sine;
  sun.importance = luminance(light.irradiance);
  const bool disk = sun.one_minus_cos > 0;
  sun.radiance = disk ? Vec3f(light.irradiance / (kPi * sine * sine)) : light.irradiance;
  sun.pdf = disk ? 1 / (2 * kPi * sun.one_minus_cos) : 0.0f;
  return sun;
}

LightSet::LightSet(const Scene& scene) : environment_(scene.environment) {
  for (const AreaLight& light : scene.area_lights) rectangles_.emplace_back(light);
  for (const SunLight& light : scene.suns) suns_.push_back(make_sun(light));
}

bool LightSet::sample_sun(const Sun& sun, const Vec2f& u, LightSample& sample) const {
  sample.direction = sun.pdf > 0 ? sun.frame.to_world(uniform_cone(u, sun.one_minus_cos)) : sun.towards;
  sample.distance = std::numeric_limits<float>::infinity();
  sample.radiance = sun.radiance;
  sample.pdf = sun.pdf > 0 ? sun.pdf : 1.0f;
  return true;
}

float LightSet::importance(std::size_t k, const Receiver& receiver) const {
  if (k < rectangles_.size()) {
    const RectangleLight& light = rectangles_[k];
    if (!receiver.both_sides && light.below(receiver.position, receiver.normal)) return 0;
    return light.importance(receiver.position);
  }
  k -= rectangles_.size();
  if (k == suns_.size()) return environment_.importance();
  const Sun& sun = suns_[k];
  const float cosine = sun.towards.dot(receiver.normal);
  if (receiver.both_sides) return sun.importance;
  // The disk reaches over the horizon by sin(half angle) <= sqrt(2 (1 - cos)).
  const float reach = std::sqrt(2 * sun.one_minus_cos);
  return cosine + reach <= 0 ? 0.0f : sun.importance * std::max(cosine, 0.05f);
}

float LightSet::probability(std::size_t k, const Receiver& receiver) const {
  if (receiver.every_light) return importance(k, receiver) > 0 ? 1.0f : 0.0f;
  if (count() == 1) return 1;
  float sum = 0;
  for (std::size_t j = 0; j < count(); ++j) sum += importance(j, receiver);
  return sum > 0 ? importance(k, receiver) / sum : 0.0f;
}

bool LightSet::sample(const Receiver& receiver, float choice, const Vec2f& u, LightSample& sample,
                      bool& point_like) const {
  const std::size_t n = count();
  if (n == 0) return false;
  std::size_t chosen = 0;
  float share = 1;
  if (n > 1) {
    float sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += importance(k, receiver);
    if (!(sum > 0)) return false;
    float below = 0;
    const float target = choice * sum;
    for (std::size_t k = 0; k < n; ++k) {
      const float part = importance(k, receiver);
      if (part <= 0) continue;
      chosen = k;
      share = part / sum;
      below += part;
      if (target < below) break;
    }
  } else if (importance(0, receiver) <= 0) {
    return false;
  }
  const bool found = sample_from(chosen, receiver, u, sample, point_like);
  sample.pdf *= share;
  return found && sample.pdf > 0;
}

bool LightSet::sample_light(std::size_t k, const Receiver& receiver, const Vec2f& u, LightSample& sample,
                            bool& point_like) const {
  return importance(k, receiver) > 0 && sample_from(k, receiver, u, sample, point_like) && sample.pdf > 0;
}

bool LightSet::sample_from(std::size_t k, const Receiver& receiver, const Vec2f& u, LightSample& sample,
                           bool& point_like) const {
  point_like = false;
  if (k < rectangles_.size()) return rectangles_[k].sample(receiver.position, u, sample);
  if (k < rectangles_.size() + suns_.size()) {
    const Sun& sun = suns_[k - rectangles_.size()];
    point_like = sun.pdf == 0;
    return sample_sun(sun, u, sample);
  }
  sample = environment_.sample(u);
  return true;
}

Vec3f LightSet::area_lights_along(const Vec3f& position, const Vec3f& direction, float distance,
                                  const RayOrigin& origin) const {
  Vec3f sum = Vec3f::Zero();
  for (std::size_t k = 0; k < rectangles_.size(); ++k) {
    const RectangleLight& light = rectangles_[k];
    float at = 0;
    if (origin.from_camera && !light.visible()) continue;
    if (!light.intersect(position, direction, distance, at)) continue;
    float weight = 1;
    if (!origin.only_way) {
      const float pdf = probability(k, origin.receiver) * light.pdf(position, direction, at);
      weight = power_heuristic(origin.pdf, pdf);
    }
    sum += weight * light.radiance();
  }
  return sum;
}

Vec3f LightSet::surroundings(const Vec3f& direction, const RayOrigin& origin) const {
  Vec3f sum = environment_.radiance(direction);
  if (!origin.only_way && environment_.sampled()) {
    const float share = probability(count() - 1, origin.receiver);
    sum *= power_heuristic(origin.pdf, share * environment_.pdf(direction));
  }
  for (std::size_t k = 0; k < suns_.size(); ++k) {
    const Sun& sun = suns_[k];
    // |d - s|^2 = 2 (1 - cos): exact for small angles, where the cosine itself is rounded to 1.
    if (sun.pdf == 0 || (direction - sun.towards).squaredNorm() > 2 * sun.one_minus_cos) continue;
    const float pdf = origin.only_way ? 0.0f : probability(rectangles_.size() + k, origin.receiver) * sun.pdf;
    sum += (origin.only_way ? 1.0f : power_heuristic(origin.pdf, pdf)) * sun.radiance;
  }
  return sum;
}

}  // namespace softreel
