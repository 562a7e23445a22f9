/// Where rays meet the ground, without a tree.
#pragma once

#include "render/pathtrace/rays/ray_scene.h"
#include "render/pathtrace/rays/surface_point.h"
#include "render/scene/ground_mesh.h"

namespace softreel {

/// Where a point of a body is: Above also before a bend or wall, Below also behind them; Near means as good as in the
/// floor, Beyond that there is no ground over or under it.
enum class FloorSide { Above, Near, Below, Beyond };

/// The surface that ground_mesh approximates, by arithmetic: a floor, a quarter of a cylinder and a wall, or the floor
/// alone. Most rays of a picture meet a studio's backdrop: in a tree it took a quarter of the time of
/// presets/first_pull.toml.
///
/// What lies on the hollow side of all three is convex, so a line that begins there meets the ground once at most.
///
/// Bodies stand on the floor with soles that lie in it up to rounding. What is so near the floor that rays which leave
/// it could start below counts as buried: the ray of a glass body meets the floor, not the sole.
class SweptGround {
 public:
  explicit SweptGround(const GroundShape& shape);

  /// Nearest meeting on a ray, from either side; hit.triangle is its part. hit.mesh, u and v are left alone.
  bool intersect(const Ray& ray, RayHit& hit) const;
  /// Whether the ray meets it before its end.
  bool blocks(const Ray& ray) const;
  /// How far before a hit of the floor the ray is nearer to it than that, m; 0 for other parts.
  float depth_of_burial(const RayHit& hit, const Ray& ray) const;
  FloorSide side_of_floor(const Vec3f& position) const;
  /// Where `ray` met it, with exact normals.
  SurfacePoint surface_point(const RayHit& hit, const Ray& ray) const;

 private:
  enum Part : Index { kFloor, kBend, kWall, kNothing };

  /// Of a ray: m, along and up, and across.
  struct Line {
    Vec2f origin, direction;
    float across, across_direction;
  };
  struct Crossing {
    float distance;
    Part part;
  };

  /// Distances at which a line meets the bend's circle; of one that misses it, where it is nearest.
  struct CirclePoints {
    float enters, leaves;
    bool are_met;
  };

  Line line_of(const Ray& ray) const;
  Vec2f in_profile(const Vec3f& point) const { return {point.dot(shape_.along), point.y()}; }
  bool reaches(const Line& line, float distance) const;
  Crossing nearest_crossing(const Line& line, float max_distance) const;
  Crossing leaving_crossing(const Line& line, float max_distance) const;
  CirclePoints meet_circle(const Line& line) const;
  void cross_floor(const Line& line, Crossing& nearest) const;
  void cross_wall(const Line& line, Crossing& nearest) const;
  void cross_bend(const Line& line, Crossing& nearest) const;

  static constexpr float kNear = 2.5f;  ///< start offsets: that of the sole, that of the ray's own start, and rounding
  GroundShape shape_;
  Vec2f center_;   ///< of the bend's circle; without a wall, of no size and where the floor ends
  float back_;     ///< along, of the wall
  float overlap_;  ///< m, parts that touch each other reach so far over, for rounding to leave no gap
};

}  // namespace softreel
