/// A rectangle that emits from one side, sampled by the solid angle it fills.
#pragma once

#include "render/scene/light.h"

namespace softreel {

/// A direction towards a light, from one point.
struct LightSample {
  Vec3f direction;     ///< unit
  float distance = 0;  ///< m; infinite for what is not in the scene
  Vec3f radiance;
  float pdf = 0;  ///< by solid angle; 0: a direction that only this light can find (a point-like sun)
};

/// What flat lamps of any outline share. The radius is that of the sphere around the lamp.
struct FlatLamp {
  Vec3f center, normal;  ///< it emits to the side of the normal
  float area = 0, squared_radius = 0;

  /// Where a ray meets the lamp's plane from the emitting side before max_distance; place: from the centre.
  bool meets_plane(const Vec3f& origin, const Vec3f& direction, float max_distance, float& distance,
                   Vec3f& place) const;
  /// Rough irradiance at p on a surface facing the lamp: 0 only if there is none.
  float importance(const Vec3f& p, float luminance) const;
};

class RectangleLight {
 public:
  /// Throws input_error if the edges are not perpendicular or have no length.
  explicit RectangleLight(const AreaLight& light);

  /// False if p is behind the light. Near the light: Urena, Fajardo and King, An Area-Preserving Parametrization for
  /// Spherical Rectangles, 2013; far from it, where the two hardly differ, evenly over the area.
  bool sample(const Vec3f& p, const Vec2f& u, LightSample& sample) const;
  /// Density of sample() from `origin` for the direction that meets the light at `distance`.
  float pdf(const Vec3f& origin, const Vec3f& direction, float distance) const;
  /// Where a ray meets the emitting side before max_distance.
  bool intersect(const Vec3f& origin, const Vec3f& direction, float max_distance, float& distance) const;

  const Vec3f& radiance() const { return radiance_; }
  bool visible() const { return visible_; }
  /// Whether it emits at all.
  bool shines() const { return luminance_ > 0; }
  /// Rough irradiance at p on a surface facing the light: 0 only if there is none.
  float importance(const Vec3f& p) const;
  /// Whether all of the light is below the plane through p.
  bool below(const Vec3f& p, const Vec3f& normal) const;

 private:
  /// The rectangle seen from a point: edges of its projection in the light's axes and the sphere's angles.
  struct Solid {
    float x0, x1, y0, y1, z0;  ///< corner coordinates relative to the point; z0 < 0
    float b0, b1, k, angle;    ///< as in the paper; angle: of the whole light, sr
  };
  Solid solid_from(const Vec3f& p) const;
  FlatLamp flat() const { return {center_, normal_, area_, radius2_}; }
  bool is_far(const Vec3f& p) const { return (center_ - p).squaredNorm() > kFar * kFar * radius2_; }

  static constexpr float kFar = 4;  ///< distances over half diagonals; the density then varies by about a quarter
  Vec3f center_, x_, y_, normal_;
  float half_x_, half_y_, area_, radius2_;
  Vec3f radiance_;
  bool visible_;
  float luminance_;
};

}  // namespace softreel
