#include "tool/shot/keyed_look.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/shot/codecs.h"

namespace softreel {
namespace {

AreaLight lamp_at(const LightSettings& light, double frame) {
  const Vec3 center = light.center.at(frame), color = light.color.at(frame);
  const double power = light.power.at(frame);
  AreaLight lamp;
  lamp.center = center.cast<float>();
  lamp.visible = light.visible;
  if (light.kind == LightKind::Sphere) {
    lamp.shape = LampShape::Sphere;
    lamp.u = Vec3f(static_cast<float>(light.radius), 0, 0);
    // All of the power leaves through the surface, evenly: pi radiance from each part of it.
    const double surface = 4 * std::numbers::pi * light.radius * light.radius;
    lamp.radiance = (color * (power / (std::numbers::pi * surface))).cast<float>();
    return lamp;
  }
  const Vec3 way = light.aim.at(frame) - center;
  if (way.isZero(0))
    throw input_error(
        fmt::format("{}: the light aims at its own center at frame {}.\n"
                    "  Accepted: keys that keep the two apart. Move center or aim.",
                    to_string(light.origin), frame));
  const Vec3 normal = way.normalized();
  // A lamp that looks straight up or down lies along x; any other stands upright.
  const Vec3 across = std::abs(normal.y()) > 0.999999 ? Vec3(Vec3::UnitX()) : Vec3::UnitY().cross(normal).normalized();
  const Vec3 upward = normal.cross(across);
  lamp.shape = light.kind == LightKind::Disk ? LampShape::Disk : LampShape::Rectangle;
  lamp.u = (0.5 * light.size.x() * across).cast<float>();
  lamp.v = (0.5 * light.size.y() * upward).cast<float>();
  const double round = light.kind == LightKind::Disk ? std::numbers::pi / 4 : 1.0;
  lamp.radiance = (color * (power / (4 * round * light.size.x() * light.size.y()))).cast<float>();
  return lamp;
}

SunLight sun_at(const LightSettings& light, double frame) {
  const Vec3 direction = light.direction.at(frame);
  if (direction.isZero(0))
    throw input_error(
        fmt::format("{}: the sun's direction has no length at frame {}.\n"
                    "  Accepted: keys that turn it without passing through [0, 0, 0]. Add a key between them.",
                    to_string(light.origin), frame));
  SunLight sun;
  sun.direction = direction.normalized().cast<float>();
  sun.irradiance = (light.color.at(frame) * light.irradiance.at(frame)).cast<float>();
  sun.angular_diameter = static_cast<float>(to_radians(light.angle_deg));
  return sun;
}

}  // namespace

FrameLights lights_at(const Shot& shot, double frame) {
  FrameLights lights;
  for (const LightSettings& light : shot.lights) {
    if (light.kind == LightKind::Sun)
      lights.suns.push_back(sun_at(light, frame));
    else
      lights.lamps.push_back(lamp_at(light, frame));
  }
  const std::optional<Daylight> day = daylight_at(shot, frame);
  if (day && shot.sky->sun) {
    const SkyModel sky(*day);
    SunLight sun;
    sun.direction = -sky.towards_sun();
    sun.irradiance = static_cast<float>(shot.environment_strength.at(frame)) * sky.sun_irradiance();
    sun.angular_diameter = static_cast<float>(to_radians(shot.sky->sun_angle_deg));
    lights.suns.push_back(sun);
  }
  return lights;
}

Environment environment_at(const Shot& shot, double frame) {
  Environment environment = shot.environment;
  environment.strength = static_cast<float>(shot.environment_strength.at(frame));
  environment.rotation = static_cast<float>(to_radians(shot.environment_rotation_deg.at(frame)));
  return environment;
}

std::optional<Daylight> daylight_at(const Shot& shot, double frame) {
  if (!shot.sky) return std::nullopt;
  Daylight day;
  day.elevation = static_cast<float>(to_radians(shot.sky->elevation_deg.at(frame)));
  day.azimuth = static_cast<float>(to_radians(shot.sky->azimuth_deg.at(frame)));
  day.turbidity = static_cast<float>(shot.sky->turbidity.at(frame));
  day.ground_albedo = static_cast<float>(shot.sky->ground_albedo);
  return day;
}

Appearance appearance_at(const MaterialSettings& material, double frame) {
  Appearance appearance = material.appearance;
  for (const AppearanceTrack& track : material.tracks) {
    if (track.number != nullptr) appearance.*track.number = static_cast<float>(track.numbers.at(frame));
    if (track.color != nullptr) appearance.*track.color = track.colors.at(frame).cast<float>();
  }
  return appearance;
}

}  // namespace softreel
