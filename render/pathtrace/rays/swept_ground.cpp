#include "render/pathtrace/rays/swept_ground.h"

#include <algorithm>
#include <cmath>

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

inline bool SweptGround::is_hollow_at(const Vec2f& point) const {
  if (point.y() <= shape_.height) return false;
  if (!shape_.has_wall || point.x() <= center_.x()) return true;
  if (point.x() >= back_) return false;
  return point.y() >= center_.y() || (point - center_).squaredNorm() < shape_.radius * shape_.radius;
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

void SweptGround::cross_bend(const Line& line, Crossing& nearest) const {
  const Vec2f from_center = line.origin - center_, &d = line.direction;
  // |from_center + t d|^2 = r^2. The discriminant by the line's distance from the centre, which cancels less.
  const float a = d.squaredNorm(), b = from_center.dot(d),
              c = from_center.squaredNorm() - shape_.radius * shape_.radius;
  const float moment = d.x() * from_center.y() - d.y() * from_center.x();
  const float discriminant = shape_.radius * shape_.radius * a - moment * moment;
  if (!(discriminant >= 0)) return;
  const float root = std::sqrt(discriminant);
  const auto keep = [&](float distance) {
    if (!(distance > 0 && distance < nearest.distance)) return;
    const Vec2f point = line.origin + distance * d;
    if (point.x() >= center_.x() - overlap_ && point.y() <= center_.y() + overlap_ && reaches(line, distance))
      nearest = {distance, kBend};
  };
  // From inside the circle the first root is behind; near it, a difference would not tell its sign.
  if (c > 0 && b < 0) keep(c / (root - b));
  if (c < 0 || b < 0) keep(b <= 0 ? (root - b) / a : -c / (root + b));
}

/// part: kNothing if it meets none of them.
inline SweptGround::Crossing SweptGround::nearest_crossing(const Line& line, float max_distance) const {
  Crossing nearest{max_distance, kNothing};
  const bool hollow = is_hollow_at(line.origin);
  // Up and towards the camera there is no ground.
  if (hollow && line.direction.y() >= 0 && line.direction.x() <= 0) return nearest;
  if (!hollow || line.direction.y() < 0) cross_floor(line, nearest);
  if (!shape_.has_wall || (hollow && nearest.part != kNothing)) return nearest;
  if (!hollow || line.direction.x() > 0) cross_wall(line, nearest);
  if (hollow && nearest.part != kNothing) return nearest;
  cross_bend(line, nearest);
  return nearest;
}

bool SweptGround::blocks(const Ray& ray) const {
  const Line line = line_of(ray);
  if (std::isfinite(ray.max_distance) && is_hollow_at(line.origin) &&
      is_hollow_at(line.origin + ray.max_distance * line.direction))
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
  if (along < -shape_.half_width || along > shape_.floor_end ||
      std::abs(position.dot(shape_.across)) > shape_.half_width)
    return FloorSide::Beyond;
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
