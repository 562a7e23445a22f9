#include "render/pathtrace/rays/swept_ground.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softreel {

SweptGround::SweptGround(const GroundShape& shape)
    : shape_(shape),
      center_(shape.floor_end, shape.height + shape.radius),
      back_(shape.floor_end + shape.radius),
      overlap_(shape.has_wall ? 1e-5f * (std::abs(shape.floor_end) + std::abs(shape.height) + shape.radius) : 0.0f) {}

inline SweptGround::Line SweptGround::line_of(const Ray& ray) const {
  return {in_profile(ray.origin), in_profile(ray.direction), ray.origin.dot(shape_.across),
          ray.direction.dot(shape_.across)};
}

/// Whether the ground is as wide as where the line is then.
bool SweptGround::reaches(const Line& line, float distance) const {
  return std::abs(line.across + distance * line.across_direction) <= shape_.half_width;
}

// A line along a part divides by 0: what comes of it is infinite or not a number, and fails its comparisons.

void SweptGround::cross_floor(const Line& line, Crossing& nearest) const {
  const float distance = (shape_.height - line.origin.y()) / line.direction.y();
  if (!(distance > 0 && distance < nearest.distance)) return;
  const float along = line.origin.x() + distance * line.direction.x();
  if (along >= -shape_.half_width && along <= shape_.floor_end + overlap_ && reaches(line, distance))
    nearest = {distance, kFloor};
}

void SweptGround::cross_wall(const Line& line, Crossing& nearest) const {
  const float distance = (back_ - line.origin.x()) / line.direction.x();
  if (!(distance > 0 && distance < nearest.distance)) return;
  const float up = line.origin.y() + distance * line.direction.y();
  if (up >= center_.y() - overlap_ && up <= shape_.top && reaches(line, distance)) nearest = {distance, kWall};
}

inline SweptGround::CirclePoints SweptGround::meet_circle(const Line& line) const {
  const Vec2f from_center = line.origin - center_, &d = line.direction;
  // |from_center + t d|^2 = r^2. The discriminant by the line's distance from the centre, which cancels less.
  const float a = d.squaredNorm(), b = from_center.dot(d),
              c = from_center.squaredNorm() - shape_.radius * shape_.radius;
  const float moment = d.x() * from_center.y() - d.y() * from_center.x();
  const float discriminant = shape_.radius * shape_.radius * a - moment * moment;
  const float root = std::sqrt(std::max(discriminant, 0.0f));
  // Neither by a difference of what is nearly equal.
  if (b <= 0) return {c / (root - b), (root - b) / a, discriminant >= 0};
  return {-(root + b) / a, -c / (root + b), discriminant >= 0};
}

void SweptGround::cross_bend(const Line& line, Crossing& nearest) const {
  const CirclePoints circle = meet_circle(line);
  if (!circle.are_met) return;
  for (const float distance : {circle.enters, circle.leaves}) {
    if (!(distance > 0 && distance < nearest.distance)) continue;
    const Vec2f point = line.origin + distance * line.direction;
    if (point.x() >= center_.x() - overlap_ && point.y() <= center_.y() + overlap_ && reaches(line, distance))
      nearest = {distance, kBend};
  }
}

/// Of a line that begins on the hollow side, which is convex: it leaves through one part, or past its rim. That is the
/// bend where it is neither floor nor wall, however near the line runs to it.
inline SweptGround::Crossing SweptGround::leaving_crossing(const Line& line, float max_distance) const {
  const Vec2f &o = line.origin, &d = line.direction;
  const auto hit_within = [&](float distance, Part part, bool is_within_rim) -> Crossing {
    const bool is_hit = is_within_rim && distance > 0 && distance < max_distance && reaches(line, distance);
    return is_hit ? Crossing{distance, part} : Crossing{max_distance, kNothing};
  };
  float first = std::numeric_limits<float>::infinity();
  if (d.y() < 0) {
    const float distance = (shape_.height - o.y()) / d.y(), along = o.x() + distance * d.x();
    if (!shape_.has_wall || along <= shape_.floor_end)
      return hit_within(distance, kFloor, along >= -shape_.half_width && along <= shape_.floor_end);
    first = distance;
  }
  if (!shape_.has_wall || (d.y() >= 0 && d.x() <= 0)) return {max_distance, kNothing};
  if (d.x() > 0) {
    const float distance = (back_ - o.x()) / d.x(), up = o.y() + distance * d.y();
    if (up >= center_.y()) return hit_within(distance, kWall, up <= shape_.top);
    first = std::min(first, distance);
  }
  return hit_within(std::min(meet_circle(line).leaves, first), kBend, true);
}

/// part: kNothing if it meets none of them.
inline SweptGround::Crossing SweptGround::nearest_crossing(const Line& line, float max_distance) const {
  if (is_hollow_at(shape_, line.origin)) return leaving_crossing(line, max_distance);
  Crossing nearest{max_distance, kNothing};
  cross_floor(line, nearest);
  if (!shape_.has_wall) return nearest;
  cross_wall(line, nearest);
  cross_bend(line, nearest);
  return nearest;
}

bool SweptGround::blocks(const Ray& ray) const {
  const Line line = line_of(ray);
  if (std::isfinite(ray.max_distance) && is_hollow_at(shape_, line.origin) &&
      is_hollow_at(shape_, Vec2f(line.origin + ray.max_distance * line.direction)))
    return false;
  return nearest_crossing(line, ray.max_distance).part != kNothing;
}

bool SweptGround::intersect(const Ray& ray, RayHit& hit) const {
  const Crossing nearest = nearest_crossing(line_of(ray), ray.max_distance);
  hit.distance = nearest.distance;
  hit.triangle = nearest.part;
  return nearest.part != kNothing;
}

float SweptGround::depth_of_burial(const RayHit& hit, const Ray& ray) const {
  if (hit.triangle != kFloor) return 0;
  const Vec3f position = ray.origin + hit.distance * ray.direction;
  return kNear * start_offset(position, hit.distance) / std::abs(ray.direction.y());
}

FloorSide SweptGround::side_of_floor(const Vec3f& position) const {
  const float along = position.dot(shape_.along);
  if (along < -shape_.half_width || std::abs(position.dot(shape_.across)) > shape_.half_width) return FloorSide::Beyond;
  if (along > shape_.floor_end) {
    if (!shape_.has_wall) return FloorSide::Beyond;
    return is_hollow_at(shape_, position) ? FloorSide::Above : FloorSide::Below;
  }
  const float height = position.y() - shape_.height;
  if (std::abs(height) < kNear * start_offset(position, 0)) return FloorSide::Near;
  return height > 0 ? FloorSide::Above : FloorSide::Below;
}

SurfacePoint SweptGround::surface_point(const RayHit& hit, const Ray& ray) const {
  SurfacePoint point;
  point.position = ray.origin + hit.distance * ray.direction;
  Vec3f& normal = point.geometric_normal;
  // What rounding has moved off the surface goes back onto it.
  if (hit.triangle == kFloor) {
    normal = Vec3f(0, 1, 0);
    point.position.y() = shape_.height;
  } else if (hit.triangle == kWall) {
    normal = -shape_.along;
    point.position += (back_ - point.position.dot(shape_.along)) * shape_.along;
  } else {
    const Vec2f outward = in_profile(point.position) - center_;
    const float length = outward.norm();
    normal = (-outward.x() / length) * shape_.along - Vec3f(0, outward.y() / length, 0);
    point.position += (length - shape_.radius) * normal;
  }
  point.inside = normal.dot(ray.direction) > 0;
  if (point.inside) normal = -normal;
  point.shading_normal = normal;
  set_ray_starts(point, hit.distance);
  return point;
}

}  // namespace softreel
