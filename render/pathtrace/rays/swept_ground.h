/// Where rays meet the ground, without a tree.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/pathtrace/rays/ray_scene.h"

namespace softreel {

/// The triangles of ground_mesh, found by arithmetic: all rows of its vertices are the same line, moved along a profile
/// in the plane of the along and up axes. The profile bends one way only and by a right angle at most, so that a line
/// meets it twice at most, and its bent part, an arc, next to where it meets the circle. Most rays of a picture meet a
/// studio's backdrop: in a tree it took a quarter of the time of presets/first_pull.toml.
class SweptGround {
 public:
  /// mesh: as ground_mesh makes it.
  explicit SweptGround(const MotionMesh& mesh);

  /// Nearest triangle on a ray, from either side. hit.mesh is left alone.
  bool intersect(const Ray& ray, RayHit& hit) const;
  /// Whether the ray meets it before its end.
  bool blocks(const Ray& ray) const;

 private:
  /// Of a ray: m, along, up and across.
  struct Line {
    Vec2f origin, direction;
    float across, across_direction;
  };
  /// A point of the profile between row `row` and the next.
  struct Crossing {
    float distance;
    std::size_t row;
    float share;
  };

  Line line_of(const Ray& ray) const;
  /// Whether a point is on the hollow side of the profile, which a line leaves once; false also of some that are.
  bool is_well_inside(const Vec2f& point) const {
    const Vec2f &bend = profile_[bend_], &wall = profile_[wall_];
    return point.y() > bend.y() && point.x() < wall.x() && (point.x() <= bend.x() || point.y() >= wall.y());
  }
  /// Where the line meets the profile first; share is below 0 if nowhere.
  Crossing nearest_crossing(const Line& line, float max_distance) const;
  /// The profile's two straight parts, from row `first` to row `last`. axis: the one that they are level on.
  void cross_straight(const Line& line, std::size_t first, std::size_t last, int axis, int& found,
                      Crossing& nearest) const;
  void cross_bend(const Line& line, int straight_crossings, Crossing& nearest) const;
  /// Between two rows of the bend that are on different sides of the line.
  void cross_between(const Line& line, std::size_t first, std::size_t last, Crossing& nearest) const;
  /// The row below the point at which the line meets the arc's circle, or one near it. leaves: the second such point.
  std::size_t row_of_circle(const Line& line, bool leaves) const;
  /// The row of the bend that is farthest to one side of the line, where the bend runs as the line does.
  std::size_t extreme_row(const Line& line) const;
  /// Side of the line that a row is on, by its sign.
  float side(const Line& line, std::size_t row) const;
  void keep_nearer(const Line& line, const Crossing& crossing, Crossing& nearest) const;

  Vec3f across_, along_;
  float half_width_;
  std::size_t cells_;             ///< across
  std::vector<Vec2f> profile_;    ///< per row: along, up
  std::size_t bend_, wall_;       ///< rows where the bend begins and ends; both the last row if there is no wall
  Vec2f center_ = Vec2f::Zero();  ///< of the bend's arc
  float radius_ = 0;
  static constexpr std::size_t kPlaces = 128;
  /// Row of the bend by along + up from its beginning, which grows evenly enough along an arc; in steps of 2 radii over
  /// kPlaces.
  std::array<std::uint32_t, kPlaces + 1> row_at_{};
};

}  // namespace softreel
