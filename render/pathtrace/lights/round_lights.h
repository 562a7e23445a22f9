/// Lamps with a round outline: an elliptic disk that emits from one side, and a sphere.
#pragma once

#include "render/pathtrace/lights/rectangle_light.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {

/// The members mean what they mean for RectangleLight.
class DiskLight {
 public:
  /// Throws input_error if the half axes are not perpendicular or have no length.
  explicit DiskLight(const AreaLight& light);

  /// Even over the area.
  bool sample(const Vec3f& p, const Vec2f& u, LightSample& sample) const;
  float pdf(const Vec3f& origin, const Vec3f& direction, float distance) const;
  bool intersect(const Vec3f& origin, const Vec3f& direction, float max_distance, float& distance) const;
  const Vec3f& radiance() const { return radiance_; }
  bool visible() const { return visible_; }
  bool shines() const { return luminance_ > 0; }
  float importance(const Vec3f& p) const;
  bool below(const Vec3f& p, const Vec3f& normal) const;

 private:
  FlatLamp flat() const { return {center_, normal_, area_, radius2_}; }

  Vec3f center_, u_, v_, normal_;  ///< u_, v_: half axes
  float area_, radius2_;           ///< radius2_: of the sphere around it
  Vec3f radiance_;
  bool visible_;
  float luminance_;
};

/// Emits outwards; seen from inside there is nothing.
class SphereLight {
 public:
  /// Throws input_error if |u| is not above 0.
  explicit SphereLight(const AreaLight& light);

  /// Even over the solid angle of the cone that holds the sphere.
  bool sample(const Vec3f& p, const Vec2f& u, LightSample& sample) const;
  float pdf(const Vec3f& origin, const Vec3f& direction, float distance) const;
  bool intersect(const Vec3f& origin, const Vec3f& direction, float max_distance, float& distance) const;
  const Vec3f& radiance() const { return radiance_; }
  bool visible() const { return visible_; }
  bool shines() const { return luminance_ > 0; }
  float importance(const Vec3f& p) const;
  bool below(const Vec3f& p, const Vec3f& normal) const;

 private:
  /// 1 - cos of the half angle that the sphere fills; 0 from inside.
  float one_minus_cos(const Vec3f& p) const;

  Vec3f center_;
  float radius_;
  Vec3f radiance_;
  bool visible_;
  float luminance_;
};

}  // namespace softreel
