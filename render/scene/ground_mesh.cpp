#include "render/scene/ground_mesh.h"

#include <cmath>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {

namespace {

constexpr float kHalfPi = 1.57079632679f;
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

/// Adds one row of two vertices across the ground.
void add_row(MotionMesh& mesh, const Vec3f& middle, const Vec3f& half_width, const Vec3f& normal) {
  MotionMesh::Time& time = mesh.times.front();
  const auto first = static_cast<Index>(time.positions.size());
  time.positions.push_back(middle - half_width);
  time.positions.push_back(middle + half_width);
  time.normals.insert(time.normals.end(), 2, normal);
  if (first == 0) return;
  mesh.triangles.push_back({first - 2, first - 1, first + 1});
  mesh.triangles.push_back({first - 2, first + 1, first});
}

}  // namespace

MotionMesh ground_mesh(const Ground& ground, const Camera& camera) {
  if (!(ground.size > 0) || (ground.style == GroundStyle::Sweep && !(ground.sweep > 0)))
    throw input_error(
        fmt::format("ground.size = {}, ground.sweep = {} leave no ground.\n"
                    "  Accepted: m, above 0. Correct the two, or leave the ground out.",
                    ground.size, ground.sweep));
  const Axes axes = ground_axes(ground, camera);
  MotionMesh mesh;
  mesh.name = "ground";
  mesh.appearance = ground.appearance;
  mesh.times.resize(1);
  const float half = 0.5f * ground.size;
  const Vec3f up(0, 1, 0), origin(0, ground.height, 0), half_width = half * axes.across;
  add_row(mesh, origin - half * axes.along, half_width, up);
  if (ground.style == GroundStyle::Plane) {
    add_row(mesh, origin + half * axes.along, half_width, up);
    return mesh;
  }
  const float radius = arc_radius(ground);
  const Vec3f center = origin + ground.sweep * axes.along + radius * up;
  for (int k = 0; k <= kArcSegments; ++k) {
    const float angle = kHalfPi * static_cast<float>(k) / kArcSegments;
    const Vec3f outward = std::sin(angle) * axes.along - std::cos(angle) * up;
    add_row(mesh, center + radius * outward, half_width, -outward);
  }
  add_row(mesh, center + radius * axes.along + half * up, half_width, -axes.along);
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
