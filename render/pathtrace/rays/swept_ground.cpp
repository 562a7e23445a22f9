#include "render/pathtrace/rays/swept_ground.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace softreel {

namespace {

float cross(const Vec2f& a, const Vec2f& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Vertices of a row: those before the first that lies apart from the line of the first two, or turns back.
std::size_t row_length(const std::vector<Vec3f>& positions) {
  const Vec3f step = positions[1] - positions[0];
  std::size_t count = 2;
  while (count < positions.size() && (positions[count] - positions[count - 1] - step).norm() < 0.5f * step.norm())
    ++count;
  return count;
}

}  // namespace

SweptGround::SweptGround(const MotionMesh& mesh) {
  const std::vector<Vec3f>&positions = mesh.times.front().positions, &normals = mesh.times.front().normals;
  CHECK(positions.size() >= 4u);
  const std::size_t row = row_length(positions);
  CHECK(positions.size() % row == 0u);
  CHECK(mesh.triangles.size() == 2 * (row - 1) * (positions.size() / row - 1));
  cells_ = row - 1;
  const Vec3f width = positions[cells_] - positions[0];
  half_width_ = 0.5f * width.norm();
  across_ = width.normalized();
  along_ = Vec3f(across_.z(), 0, -across_.x());
  for (std::size_t first = 0; first < positions.size(); first += row) {
    const Vec3f middle = 0.5f * (positions[first] + positions[first + cells_]);
    profile_.emplace_back(middle.dot(along_), middle.y());
  }
  const auto turned = [&](std::size_t r, std::size_t from) {
    return (normals[r * row] - normals[from * row]).norm() > 1e-5f;
  };
  const std::size_t last = profile_.size() - 1;
  for (bend_ = 0; bend_ < last && !turned(bend_ + 1, 0);) ++bend_;
  for (wall_ = last; wall_ > bend_ && !turned(wall_ - 1, last);) --wall_;
  if (bend_ == wall_) return;
  center_ = Vec2f(profile_[bend_].x(), profile_[wall_].y());
  radius_ = profile_[wall_].x() - profile_[bend_].x();
  for (std::size_t place = 0, r = bend_; place <= kPlaces; ++place) {
    const float along_and_up = 2 * radius_ * static_cast<float>(place) / kPlaces;
    while (r + 1 < wall_ && (profile_[r + 1] - profile_[bend_]).sum() <= along_and_up) ++r;
    row_at_[place] = static_cast<std::uint32_t>(r);
  }
}

float SweptGround::side(const Line& line, std::size_t row) const {
  return cross(line.direction, profile_[row] - line.origin);
}

void SweptGround::keep_nearer(const Line& line, const Crossing& crossing, Crossing& nearest) const {
  if (!(crossing.distance > 0 && crossing.distance < nearest.distance)) return;
  if (std::abs(line.across + crossing.distance * line.across_direction) <= half_width_) nearest = crossing;
}

void SweptGround::cross_straight(const Line& line, std::size_t first, std::size_t last, int axis, int& found,
                                 Crossing& nearest) const {
  if (first == last) return;
  const Vec2f &a = profile_[first], &b = profile_[last];
  const float distance = (a[1 - axis] - line.origin[1 - axis]) / line.direction[1 - axis];
  const float share = (line.origin[axis] + distance * line.direction[axis] - a[axis]) / (b[axis] - a[axis]);
  if (!(share >= 0 && share <= 1)) return;
  ++found;
  const float rows = share * static_cast<float>(last - first);
  const std::size_t row = std::min(static_cast<std::size_t>(rows), last - first - 1);
  keep_nearer(line, {distance, first + row, rows - static_cast<float>(row)}, nearest);
}

void SweptGround::cross_between(const Line& line, std::size_t first, std::size_t last, Crossing& nearest) const {
  const bool first_side = side(line, first) < 0;
  const auto is_past = [&](std::size_t r) { return (side(line, r) < 0) != first_side; };
  // Where the line goes from the hollow side out it has been in the circle.
  std::size_t row = std::clamp(row_of_circle(line, first_side), first, last - 1);
  while (row > first && is_past(row)) --row;
  while (row + 1 < last && !is_past(row + 1)) ++row;
  first = row;
  const Vec2f edge = profile_[first + 1] - profile_[first], to = profile_[first] - line.origin;
  const float sine = cross(line.direction, edge);
  const float share = std::clamp(-cross(line.direction, to) / sine, 0.0f, 1.0f);
  keep_nearer(line, {cross(to, edge) / sine, first, share}, nearest);
}

std::size_t SweptGround::row_of_circle(const Line& line, bool leaves) const {
  const Vec2f from_center = line.origin - center_;
  const float a = line.direction.squaredNorm(), b = from_center.dot(line.direction),
              c = from_center.squaredNorm() - radius_ * radius_;
  const float root = std::sqrt(std::max(b * b - a * c, 0.0f));
  const Vec2f point = from_center + ((leaves ? root : -root) - b) / a * line.direction;
  const float along_and_up = point.sum() + radius_;
  const float place = along_and_up * (static_cast<float>(kPlaces) / (2 * radius_));
  return row_at_[static_cast<std::size_t>(std::min(std::max(0.0f, place), static_cast<float>(kPlaces)))];
}

std::size_t SweptGround::extreme_row(const Line& line) const {
  const auto turn = [&](std::size_t row) { return cross(line.direction, profile_[row + 1] - profile_[row]) < 0; };
  const bool before = turn(bend_);
  std::size_t low = bend_, high = wall_;  // the edge from `low` turns as the first one, that from `high` does not
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (turn(middle) == before ? low : high) = middle;
  }
  return high;
}

void SweptGround::cross_bend(const Line& line, int straight_crossings, Crossing& nearest) const {
  if (straight_crossings == 2 || bend_ == wall_) return;
  const bool bend_side = side(line, bend_) < 0;
  if (bend_side != (side(line, wall_) < 0)) {
    cross_between(line, bend_, wall_, nearest);
  } else if (straight_crossings == 0 && line.direction.x() * line.direction.y() > 0) {
    const std::size_t row = extreme_row(line);
    if ((side(line, row) < 0) == bend_side) return;
    cross_between(line, bend_, row, nearest);
    cross_between(line, row, wall_, nearest);
  }
}

SweptGround::Line SweptGround::line_of(const Ray& ray) const {
  return {{ray.origin.dot(along_), ray.origin.y()},
          {ray.direction.dot(along_), ray.direction.y()},
          ray.origin.dot(across_),
          ray.direction.dot(across_)};
}

SweptGround::Crossing SweptGround::nearest_crossing(const Line& line, float max_distance) const {
  Crossing nearest{max_distance, 0, -1};
  const bool inside = is_well_inside(line.origin);
  // Up and towards the camera there is no ground.
  if (inside && line.direction.y() >= 0 && line.direction.x() <= 0) return nearest;
  int found = 0;
  if (!inside || line.direction.y() < 0) cross_straight(line, 0, bend_, 0, found, nearest);
  if (inside && found > 0) return nearest;
  if (!inside || line.direction.x() > 0) cross_straight(line, wall_, profile_.size() - 1, 1, found, nearest);
  if (inside && found > 0) return nearest;
  cross_bend(line, inside ? 1 : found, nearest);
  return nearest;
}

bool SweptGround::blocks(const Ray& ray) const {
  const Line line = line_of(ray);
  // Nothing of what is hollow is between two points inside.
  if (std::isfinite(ray.max_distance) && is_well_inside(line.origin) &&
      is_well_inside(line.origin + ray.max_distance * line.direction))
    return false;
  return nearest_crossing(line, ray.max_distance).share >= 0;
}

bool SweptGround::intersect(const Ray& ray, RayHit& hit) const {
  const Line line = line_of(ray);
  const Crossing nearest = nearest_crossing(line, ray.max_distance);
  if (nearest.share < 0) return false;
  hit.distance = nearest.distance;
  const float place = line.across + nearest.distance * line.across_direction;
  const float columns = std::max(0.0f, (place / half_width_ + 1) * 0.5f * static_cast<float>(cells_));
  const std::size_t column = std::min(static_cast<std::size_t>(columns), cells_ - 1);
  const float x = std::min(columns - static_cast<float>(column), 1.0f), y = nearest.share;
  // A cell's first triangle is its part with x >= y.
  const std::size_t first = 2 * (nearest.row * cells_ + column);
  hit.triangle = static_cast<Index>(x >= y ? first : first + 1);
  hit.u = x >= y ? x - y : x;
  hit.v = x >= y ? y : y - x;
  return true;
}

}  // namespace softreel
