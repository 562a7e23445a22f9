/// All lights of a picture: choosing one of them, sampling it, and what a ray finds on its own.
#pragma once

#include <variant>
#include <vector>

#include "render/pathtrace/lights/emitting_meshes.h"
#include "render/pathtrace/lights/environment_light.h"
#include "render/pathtrace/lights/light_tree.h"
#include "render/pathtrace/lights/round_lights.h"
#include "render/pathtrace/rays/sampling.h"
#include "render/scene/scene.h"

namespace softreel {

/// The point that light arrives at.
struct Receiver {
  Vec3f position;
  Vec3f normal;             ///< unit, towards the viewer
  bool both_sides = false;  ///< light from behind the surface counts too (glass)
  /// Every light is sampled there instead of one that is chosen.
  bool every_light = false;
  float time = 0;  ///< of the shutter
};

/// How a ray's direction was found, for weighing light that it meets against sampling the lights.
struct RayOrigin {
  Receiver receiver;
  float pdf = 0;         ///< of the direction, by solid angle
  bool only_way = true;  ///< the camera or a mirror: no light sampling could have found the direction
  bool from_camera = true;
  Vec3f absorption = Vec3f::Zero();  ///< 1/m, of what the ray goes through
};

class LightSet {
 public:
  /// Keeps references to scene.environment and to meshes that emit. Throws input_error for lights without extent or
  /// direction.
  explicit LightSet(const Scene& scene);

  /// A direction towards one light, chosen by the rough irradiance of each at the receiver; sample.pdf includes the
  /// choice. False if no light reaches the receiver. `point_like` is set for a sun without extent.
  bool sample(const Receiver& receiver, float choice, const Vec2f& u, LightSample& sample, bool& point_like) const;

  /// Number of lights that can be chosen: lamps (many of them are one light), then suns, then all emitting meshes as
  /// one, then the environment.
  std::size_t count() const { return environment_place() + (environment_.sampled() ? 1 : 0); }
  /// A direction towards light k, as `sample`, but without the choice of k in sample.pdf. choice: picks a part of it.
  bool sample_light(std::size_t k, const Receiver& receiver, float choice, const Vec2f& u, LightSample& sample,
                    bool& point_like) const;

  /// Radiance of the area lights that a ray passes within `distance`, weighed.
  Vec3f area_lights_along(const Vec3f& position, const Vec3f& direction, float distance, const RayOrigin& origin) const;
  /// Radiance of suns and environment from a direction, weighed.
  Vec3f surroundings(const Vec3f& direction, const RayOrigin& origin) const;
  /// Whether the environment is among the lights that can be chosen; a smooth gradient is not.
  bool samples_environment() const { return environment_.sampled(); }
  Vec3f environment(const Vec3f& direction) const { return environment_.radiance(direction); }
  /// Weight of the emission of the front of a mesh that a ray hit.
  float emission_weight(const Ray& ray, const RayHit& hit, const RayOrigin& origin) const;

 private:
  struct Sun {
    Vec3f towards;  ///< unit
    ShadingFrame frame;
    float one_minus_cos;  ///< of half the angular diameter
    Vec3f radiance;       ///< irradiance if the sun has no extent
    float pdf;            ///< 0 if it has none
    float importance;
  };
  using Lamp = std::variant<RectangleLight, DiskLight, SphereLight>;

  static Lamp make_lamp(const AreaLight& light);
  static Sun make_sun(const SunLight& light);
  std::size_t lamp_places() const { return lamp_tree_.empty() ? lamps_.size() : 1; }
  std::size_t emitter_place() const { return lamp_places() + suns_.size(); }
  std::size_t environment_place() const { return emitter_place() + (emitters_.empty() ? 0 : 1); }
  bool sample_from(std::size_t k, const Receiver& receiver, float choice, const Vec2f& u, LightSample& sample,
                   bool& point_like) const;
  template <typename Visit>
  void for_lamps_near(const Vec3f& position, const Vec3f& direction, float distance, const Visit& visit) const;
  bool sample_lamps(std::size_t k, const Receiver& receiver, float choice, const Vec2f& u, LightSample& sample) const;
  bool sample_sun(const Sun& sun, const Vec2f& u, LightSample& sample) const;
  /// Rough irradiance of light k at a receiver.
  float importance(std::size_t k, const Receiver& receiver) const;
  float lamp_importance(const Lamp& lamp, const Receiver& receiver) const;
  /// False only where importance(k, receiver) is 0. Quicker: a lamp's own sampling finds out whether it shows its
  /// front.
  bool may_reach(std::size_t k, const Receiver& receiver) const;
  /// Of light k to be sampled at the receiver.
  float probability(std::size_t k, const Receiver& receiver) const;
  /// Of one lamp.
  float lamp_probability(std::size_t lamp, const Receiver& receiver) const;

  std::vector<Lamp> lamps_;
  bool has_visible_lamps_ = false;  ///< that the camera sees
  LightTree lamp_tree_;             ///< over the lamps if they are many, else empty
  std::vector<Sun> suns_;
  EmittingMeshes emitters_;
  EnvironmentLight environment_;
};

}  // namespace softreel
