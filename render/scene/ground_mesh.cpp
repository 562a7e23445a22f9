#include "render/scene/ground_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {

namespace {

constexpr float kHalfPi = std::numbers::pi_v<float> / 2;
constexpr int kArcSegments = 48;
struct Axes {
  Vec3f across, along;  ///< horizontal; along: away from the camera
};

Axes ground_axes(const Ground& ground, const Camera& camera) {
  Vec3f along = camera.target - camera.position;
  along.y() = 0;
  // A plane looks the same from everywhere; its pattern must not turn with the camera. Straight down, "away" is up in
  // the picture.
  if (ground.style == GroundStyle::Plane) along = Vec3f(0, 0, -1);
  if (along.norm() < 1e-6f) along = Vec3f(camera.up.x(), 0, camera.up.z());
  if (along.norm() < 1e-6f) along = Vec3f(0, 0, -1);
  along.normalize();
  return {Vec3f(-along.z(), 0, along.x()), along};
}

float arc_radius(const Ground& ground) {
  return 0.5f * ground.sweep;
}

/// Adds one row of vertices across the ground, and the cells between it and the row before.
void add_row(MotionMesh& mesh, const Vec3f& middle, const Vec3f& half_width, const Vec3f& normal, int cells) {
  MotionMesh::Time& time = mesh.times.front();
  const auto first = static_cast<Index>(time.positions.size());
  const Index row = cells + 1;
  for (int i = 0; i <= cells; ++i) {
    const float place = 2 * static_cast<float>(i) / static_cast<float>(cells) - 1;
    time.positions.push_back(middle + place * half_width);
    time.normals.push_back(normal);
  }
  if (first == 0) return;
  for (Index b = first; b < first + cells; ++b) {
    mesh.triangles.push_back({b - row, b - row + 1, b + 1});
    mesh.triangles.push_back({b - row, b + 1, b});
  }
}

/// Adds rows at equal steps up to and without the end.
void add_flat(MotionMesh& mesh, const Vec3f& begin, const Vec3f& end, const Vec3f& half_width, const Vec3f& normal,
              int cells) {
  const float cell = 2 * half_width.norm() / static_cast<float>(cells);
  const int steps = std::max(1, static_cast<int>(std::lround((end - begin).norm() / cell)));
  for (int k = 0; k < steps; ++k) {
    const Vec3f middle = begin + static_cast<float>(k) / static_cast<float>(steps) * (end - begin);
    add_row(mesh, middle, half_width, normal, cells);
  }
}

}  // namespace

GroundShape ground_shape(const Ground& ground, const Camera& camera) {
  if (!(ground.size > 0) || (ground.style == GroundStyle::Sweep && !(ground.sweep > 0)))
    throw input_error(
        fmt::format("ground.size = {}, ground.sweep = {} leave no ground.\n"
                    "  Accepted: m, above 0. Correct the two, or leave the ground out.",
                    ground.size, ground.sweep));
  const Axes axes = ground_axes(ground, camera);
  GroundShape shape{axes.across, axes.along, ground.height, 0.5f * ground.size, 0.5f * ground.size};
  if (ground.style == GroundStyle::Plane) return shape;
  shape.floor_end = ground.sweep;
  shape.has_wall = true;
  shape.radius = arc_radius(ground);
  shape.top = ground.height + shape.radius + shape.half_width;
  return shape;
}

MotionMesh ground_mesh(const Ground& ground, const Camera& camera, int cells) {
  const GroundShape shape = ground_shape(ground, camera);
  MotionMesh mesh;
  mesh.name = "ground";
  mesh.appearance = ground.appearance;
  mesh.times.resize(1);
  const Vec3f up(0, 1, 0), origin(0, shape.height, 0), half_width = shape.half_width * shape.across;
  const Vec3f begin = origin - shape.half_width * shape.along, end = origin + shape.floor_end * shape.along;
  if (!shape.has_wall) {
    add_row(mesh, begin, half_width, up, 1);
    add_row(mesh, end, half_width, up, 1);
    return mesh;
  }
  const Vec3f center = end + shape.radius * up;
  add_flat(mesh, begin, end, half_width, up, cells);
  for (int k = 0; k < kArcSegments; ++k) {
    const float angle = kHalfPi * static_cast<float>(k) / kArcSegments;
    const Vec3f outward = std::sin(angle) * shape.along - std::cos(angle) * up;
    add_row(mesh, center + shape.radius * outward, half_width, -outward, cells);
  }
  const Vec3f wall = center + shape.radius * shape.along, top = wall + (shape.top - center.y()) * up;
  add_flat(mesh, wall, top, half_width, -shape.along, cells);
  add_row(mesh, top, half_width, -shape.along, cells);
  return mesh;
}

GroundPattern::GroundPattern(const Ground& ground, const Camera& camera)
    : style_(ground.style), height_(ground.height), sweep_(ground.sweep), edge_(ground.checker) {
  const Axes axes = ground_axes(ground, camera);
  across_ = axes.across;
  along_ = axes.along;
}

bool GroundPattern::alternate(const Vec3f& position) const {
  if (!(edge_ > 0)) return false;
  const float x = position.dot(across_);
  float y = position.dot(along_);
  if (style_ == GroundStyle::Sweep && y > sweep_) {
    const float radius = 0.5f * sweep_, rise = position.y() - height_;
    y = rise < radius ? sweep_ + radius * std::atan2(y - sweep_, radius - rise)
                      : sweep_ + radius * kHalfPi + (rise - radius);
  }
  const float squares = std::floor(x / edge_) + std::floor(y / edge_);
  return std::fmod(std::abs(squares), 2.0f) == 1.0f;
}

}  // namespace softreel
