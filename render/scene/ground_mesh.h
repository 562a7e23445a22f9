/// The ground as triangles, and the pattern on it.
#pragma once

#include "render/scene/scene.h"

namespace softreel {

/// A square around the origin (Plane), or the studio backdrop (Sweep): the square as far as `sweep` metres away from
/// the camera, then a quarter circle of radius sweep / 2, then a wall.
struct GroundShape {
  Vec3f across, along;    ///< unit, horizontal; along: of a Sweep, away from the camera
  float height = 0;       ///< m, of the floor
  float half_width = 0;   ///< m, across to both sides; the floor begins so far before the origin
  float floor_end = 0;    ///< m, along
  bool has_wall = false;  ///< and the bend before it:
  float radius = 0;       ///< m, of the bend
  float top = 0;          ///< m, height at which the wall ends
};

/// Whether a point is on the side of a ground from which it is seen: above the floor, and before bend and wall. No line
/// between two such points meets the ground. profile: m, along and up.
inline bool is_hollow_at(const GroundShape& shape, const Vec2f& profile) {
  if (profile.y() <= shape.height) return false;
  if (!shape.has_wall || profile.x() <= shape.floor_end) return true;
  if (profile.x() >= shape.floor_end + shape.radius) return false;
  const Vec2f from_center = profile - Vec2f(shape.floor_end, shape.height + shape.radius);
  return from_center.y() >= 0 || from_center.squaredNorm() < shape.radius * shape.radius;
}
inline bool is_hollow_at(const GroundShape& shape, const Vec3f& point) {
  return is_hollow_at(shape, Vec2f(point.dot(shape.along), point.y()));
}

/// Throws input_error for a size or sweep that leaves no ground.
GroundShape ground_shape(const Ground& ground, const Camera& camera);

/// Cells of a Sweep, across, for a tree. It stands askew in the world: the boxes that a tree puts round long strips
/// would overlap, and every ray would have to try dozens of them (measured: 6 % of the time of a picture).
inline constexpr int kTreeCells = 64;

/// Its triangles. Normals are smooth and exact on the arc. Errors as ground_shape.
MotionMesh ground_mesh(const Ground& ground, const Camera& camera, int cells = kTreeCells);

/// The two-tone pattern; on a Sweep its squares follow the backdrop up the wall.
class GroundPattern {
 public:
  GroundPattern(const Ground& ground, const Camera& camera);
  /// Whether a point of the ground has checker_color. False everywhere without a pattern.
  bool alternate(const Vec3f& position) const;
  /// The pattern's horizontal axes, unit.
  const Vec3f& across() const { return across_; }
  const Vec3f& along() const { return along_; }

 private:
  GroundStyle style_;
  float height_, sweep_, edge_;
  Vec3f across_, along_;
};

}  // namespace softreel
