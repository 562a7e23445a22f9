#include "render/pathtrace/lights/light_set.h"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include "core/base/error.h"
#include "render/pathtrace/materials/scattering.h"

namespace softreel {

namespace {

/// More lamps than these are chosen from by a tree: by steps that grow with the logarithm of their number. For few,
/// one rough irradiance each is the better choice and as quick.
constexpr std::size_t kFewLamps = 16;
/// Of many lamps near one ray, as many are told from the others by the tree.
constexpr std::size_t kMostPassed = 64;
/// Lights whose importance is not computed twice.
constexpr std::size_t kKeptImportances = 8;

TreeReceiver in_tree(const Receiver& receiver) {
  return {receiver.position, receiver.normal, receiver.both_sides};
}

EmitterBounds bounds_of(const AreaLight& light) {
  EmitterBounds bounds;
  const bool is_sphere = light.shape == LampShape::Sphere;
  const Vec3f half =
      is_sphere ? Vec3f(Vec3f::Constant(light.u.norm())) : Vec3f(light.u.cwiseAbs() + light.v.cwiseAbs());
  bounds.low = light.center - half;
  bounds.high = light.center + half;
  const Vec3f normal = light.u.cross(light.v).normalized();
  bounds.normals = is_sphere ? DirectionCone{Vec3f(0, 0, 1), kPi} : DirectionCone{normal, 0};
  const float area = is_sphere                        ? kPi * light.u.squaredNorm()
                     : light.shape == LampShape::Disk ? kPi * light.u.norm() * light.v.norm()
                                                      : 4 * light.u.norm() * light.v.norm();
  bounds.power_by_pi = luminance(light.radiance) * area;
  return bounds;
}

std::vector<EmitterBounds> bounds_of_many(const std::vector<AreaLight>& lights) {
  std::vector<EmitterBounds> bounds;
  if (lights.size() > kFewLamps)
    for (const AreaLight& light : lights) bounds.push_back(bounds_of(light));
  return bounds;
}

}  // namespace

LightSet::Lamp LightSet::make_lamp(const AreaLight& light) {
  if (light.shape == LampShape::Disk) return DiskLight(light);
  if (light.shape == LampShape::Sphere) return SphereLight(light);
  return RectangleLight(light);
}

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

LightSet::LightSet(const Scene& scene)
    : lamp_tree_(bounds_of_many(scene.area_lights)), emitters_(scene.meshes), environment_(scene.environment) {
  for (const AreaLight& light : scene.area_lights) {
    lamps_.push_back(make_lamp(light));
    has_visible_lamps_ = has_visible_lamps_ || light.visible;
  }
  for (const SunLight& light : scene.suns) suns_.push_back(make_sun(light));
}

bool LightSet::sample_sun(const Sun& sun, const Vec2f& u, LightSample& sample) const {
  sample.direction = sun.pdf > 0 ? sun.frame.to_world(uniform_cone(u, sun.one_minus_cos)) : sun.towards;
  sample.distance = std::numeric_limits<float>::infinity();
  sample.radiance = sun.radiance;
  sample.pdf = sun.pdf > 0 ? sun.pdf : 1.0f;
  return true;
}

float LightSet::lamp_importance(const Lamp& lamp, const Receiver& receiver) const {
  return std::visit(
      [&](const auto& light) {
        if (!receiver.both_sides && light.below(receiver.position, receiver.normal)) return 0.0f;
        return light.importance(receiver.position);
      },
      lamp);
}

float LightSet::importance(std::size_t k, const Receiver& receiver) const {
  if (k < lamp_places())
    return lamp_tree_.empty() ? lamp_importance(lamps_[k], receiver) : lamp_tree_.importance(in_tree(receiver));
  if (k >= environment_place()) return environment_.importance();
  if (k >= emitter_place()) return emitters_.importance(in_tree(receiver));
  const Sun& sun = suns_[k - lamp_places()];
  const float cosine = sun.towards.dot(receiver.normal);
  if (receiver.both_sides) return sun.importance;
  // The disk reaches over the horizon by sin(half angle) <= sqrt(2 (1 - cos)).
  const float reach = std::sqrt(2 * sun.one_minus_cos);
  return cosine + reach <= 0 ? 0.0f : sun.importance * std::max(cosine, 0.05f);
}

inline bool LightSet::may_reach(std::size_t k, const Receiver& receiver) const {
  if (k >= lamp_places() || !lamp_tree_.empty()) return importance(k, receiver) > 0;
  return std::visit(
      [&](const auto& light) {
        return light.shines() && (receiver.both_sides || !light.below(receiver.position, receiver.normal));
      },
      lamps_[k]);
}

float LightSet::probability(std::size_t k, const Receiver& receiver) const {
  if (receiver.every_light) return importance(k, receiver) > 0 ? 1.0f : 0.0f;
  if (count() == 1) return 1;
  float sum = 0;
  for (std::size_t j = 0; j < count(); ++j) sum += importance(j, receiver);
  return sum > 0 ? importance(k, receiver) / sum : 0.0f;
}

float LightSet::lamp_probability(std::size_t lamp, const Receiver& receiver) const {
  if (lamp_tree_.empty()) return probability(lamp, receiver);
  return probability(0, receiver) * lamp_tree_.probability(in_tree(receiver), static_cast<Index>(lamp));
}

bool LightSet::sample(const Receiver& receiver, float choice, const Vec2f& u, LightSample& sample,
                      bool& point_like) const {
  const std::size_t n = count();
  if (n == 0) return false;
  std::size_t chosen = 0;
  float share = 1;
  if (n > 1) {
    float sum = 0;
    std::array<float, kKeptImportances> kept;
    for (std::size_t k = 0; k < n; ++k) {
      const float part = importance(k, receiver);
      if (k < kKeptImportances) kept[k] = part;
      sum += part;
    }
    if (!(sum > 0)) return false;
    float below = 0, start = 0;
    const float target = choice * sum;
    for (std::size_t k = 0; k < n; ++k) {
      const float part = k < kKeptImportances ? kept[k] : importance(k, receiver);
      if (part <= 0) continue;
      chosen = k;
      share = part / sum;
      start = below;
      below += part;
      if (target < below) break;
    }
    choice = std::clamp((target - start) / (share * sum), 0.0f, 0x1.fffffep-1f);
  } else if (!may_reach(0, receiver)) {
    return false;
  }
  const bool found = sample_from(chosen, receiver, choice, u, sample, point_like);
  sample.pdf *= share;
  return found && sample.pdf > 0;
}

bool LightSet::sample_light(std::size_t k, const Receiver& receiver, float choice, const Vec2f& u, LightSample& sample,
                            bool& point_like) const {
  return may_reach(k, receiver) && sample_from(k, receiver, choice, u, sample, point_like) && sample.pdf > 0;
}

inline bool LightSet::sample_lamps(std::size_t k, const Receiver& receiver, float choice, const Vec2f& u,
                                   LightSample& sample) const {
  float share = 1;
  if (!lamp_tree_.empty()) {
    Index chosen = 0;
    if (!lamp_tree_.choose(in_tree(receiver), choice, chosen, share)) return false;
    k = static_cast<std::size_t>(chosen);
  }
  const bool found = std::visit([&](const auto& lamp) { return lamp.sample(receiver.position, u, sample); }, lamps_[k]);
  sample.pdf *= share;
  return found;
}

inline bool LightSet::sample_from(std::size_t k, const Receiver& receiver, float choice, const Vec2f& u,
                                  LightSample& sample, bool& point_like) const {
  point_like = false;
  if (k < lamp_places()) return sample_lamps(k, receiver, choice, u, sample);
  if (k < emitter_place()) {
    const Sun& sun = suns_[k - lamp_places()];
    point_like = sun.pdf == 0;
    return sample_sun(sun, u, sample);
  }
  if (k < environment_place()) return emitters_.sample(in_tree(receiver), receiver.time, choice, u, sample);
  sample = environment_.sample(u);
  return true;
}

/// visit(lamp) of all lamps that a ray may meet and some others, in the order of their numbers, in which their light is
/// added up: the bits are those of asking them all.
template <typename Visit>
void LightSet::for_lamps_near(const Vec3f& position, const Vec3f& direction, float distance, const Visit& visit) const {
  if (lamp_tree_.empty()) {
    for (std::size_t k = 0; k < lamps_.size(); ++k) visit(k);
    return;
  }
  std::array<Index, kMostPassed> passed;
  std::size_t count = 0;
  lamp_tree_.visit_along(position, direction, distance, [&](Index lamp) {
    if (count < kMostPassed) passed[count] = lamp;
    ++count;
  });
  if (count > kMostPassed) {
    for (std::size_t k = 0; k < lamps_.size(); ++k) visit(k);
    return;
  }
  std::sort(passed.begin(), passed.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t j = 0; j < count; ++j) visit(static_cast<std::size_t>(passed[j]));
}

Vec3f LightSet::area_lights_along(const Vec3f& position, const Vec3f& direction, float distance,
                                  const RayOrigin& origin) const {
  Vec3f sum = Vec3f::Zero();
  if (origin.from_camera && !has_visible_lamps_) return sum;
  const auto add = [&](std::size_t k, const auto& light) {
    float at = 0;
    if (origin.from_camera && !light.visible()) return;
    if (!light.intersect(position, direction, distance, at)) return;
    float weight = 1;
    if (!origin.only_way) {
      const float pdf = lamp_probability(k, origin.receiver) * light.pdf(position, direction, at);
      weight = power_heuristic(origin.pdf, pdf);
    }
    sum += weight * light.radiance().cwiseProduct(transmittance(origin.absorption, at));
  };
  for_lamps_near(position, direction, distance,
                 [&](std::size_t k) { std::visit([&](const auto& light) { add(k, light); }, lamps_[k]); });
  return sum;
}

Vec3f LightSet::surroundings(const Vec3f& direction, const RayOrigin& origin) const {
  Vec3f sum = environment_.radiance(direction);
  if (!origin.only_way && environment_.sampled()) {
    const float share = probability(environment_place(), origin.receiver);
    sum *= power_heuristic(origin.pdf, share * environment_.pdf(direction));
  }
  for (std::size_t k = 0; k < suns_.size(); ++k) {
    const Sun& sun = suns_[k];
    // |d - s|^2 = 2 (1 - cos): exact for small angles, where the cosine itself is rounded to 1.
    if (sun.pdf == 0 || (direction - sun.towards).squaredNorm() > 2 * sun.one_minus_cos) continue;
    const float pdf = origin.only_way ? 0.0f : probability(lamp_places() + k, origin.receiver) * sun.pdf;
    sum += (origin.only_way ? 1.0f : power_heuristic(origin.pdf, pdf)) * sun.radiance;
  }
  return sum;
}

float LightSet::emission_weight(const Ray& ray, const RayHit& hit, const RayOrigin& origin) const {
  if (origin.only_way || emitters_.empty()) return 1;
  const float share = probability(emitter_place(), origin.receiver);
  return power_heuristic(origin.pdf, share * emitters_.pdf(in_tree(origin.receiver), ray, hit));
}

}  // namespace softreel
