/// A rectangle that emits from one side, sampled by the solid angle it fills.
#pragma once

#include <array>
#include <cstddef>

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

/// Points that samples of one rectangle are wanted from, and what comes of them; one array for each number, for loops
/// in vector instructions.
class RectangleSamples {
 public:
  static constexpr std::size_t kMost = 64;

  void add(const Vec3f& p, const Vec2f& u) {
    for (std::size_t c = 0; c < 3; ++c) p_[c][count_] = p[static_cast<Eigen::Index>(c)];
    u_[count_] = u.x();
    v_[count_++] = u.y();
  }
  std::size_t count() const { return count_; }
  void clear() { count_ = 0; }
  /// Of the n-th point, without radiance; pdf is 0 where RectangleLight::sample says false.
  LightSample sample(std::size_t n) const {
    return {Vec3f(direction_[0][n], direction_[1][n], direction_[2][n]), distance_[n], Vec3f::Zero(), pdf_[n]};
  }

 private:
  friend class RectangleLight;
  using Lanes = std::array<float, kMost>;

  std::size_t count_ = 0;
  alignas(32) std::array<Lanes, 3> p_{};
  alignas(32) Lanes u_{}, v_{};
  alignas(32) std::array<Lanes, 3> direction_{};
  alignas(32) Lanes distance_{}, pdf_{};
};

class RectangleLight {
 public:
  /// Throws input_error if the edges are not perpendicular or have no length.
  explicit RectangleLight(const AreaLight& light);

  /// False if p is behind the light. Near the light: Urena, Fajardo and King, An Area-Preserving Parametrization for
  /// Spherical Rectangles, 2013; far from it, where the two hardly differ, evenly over the area.
  bool sample(const Vec3f& p, const Vec2f& u, LightSample& sample) const;
  /// The same of many points, to the last bit.
  void sample(RectangleSamples& samples) const;
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
  /// A point in the light's axes, from its centre.
  struct Place {
    float x, y, height;
  };
  /// The rectangle seen from a point: edges of its projection in the light's axes and the sphere's angles.
  struct Solid {
    float x0, x1, y0, y1, z0, z2;  ///< corner coordinates relative to the point; z0 < 0; z2: its square
    float b0, b1, k, angle;        ///< as in the paper; angle: of the whole light, sr
  };
  /// A sample, from the point to the light.
  struct Local {
    float x, y, z, distance, pdf;
  };
  Place place_of(float x, float y, float z) const;
  bool is_far(const Place& p) const { return p.x * p.x + p.y * p.y + p.height * p.height > kFar * kFar * radius2_; }
  Solid solid_from(const Place& p) const;
  Local sample_near(const Place& p, float u, float v) const;
  Local sample_far(const Place& p, float u, float v) const;
  Local to_world(const Local& at) const;
  FlatLamp flat() const { return {center_, normal_, area_, radius2_}; }

  static constexpr float kFar = 4;  ///< distances over half diagonals; the density then varies by about a quarter
  Vec3f center_, x_, y_, normal_;
  float half_x_, half_y_, area_, radius2_;
  Vec3f radiance_;
  bool visible_;
  float luminance_;
};

}  // namespace softreel
