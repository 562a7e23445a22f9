// The ground by arithmetic against its profile in short straight steps, in double.
#include "render/pathtrace/rays/swept_ground.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "render/pathtrace/rays/scene_rays.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// Along and up: the floor, the arc in 4096 steps, the wall.
std::vector<Eigen::Vector2d> profile_of(const GroundShape& shape) {
  const double radius = static_cast<double>(shape.radius), height = static_cast<double>(shape.height);
  const double end = static_cast<double>(shape.floor_end);
  std::vector<Eigen::Vector2d> profile{{-static_cast<double>(shape.half_width), height}, {end, height}};
  if (!shape.has_wall) return profile;
  constexpr int kSteps = 4096;
  for (int k = 1; k <= kSteps; ++k) {
    const double angle = std::numbers::pi / 2 * k / kSteps;
    profile.emplace_back(end + radius * std::sin(angle), height + radius * (1 - std::cos(angle)));
  }
  profile.emplace_back(end + radius, static_cast<double>(shape.top));
  return profile;
}

/// Nearest meeting with a step of the profile; infinite if none.
double nearest(const GroundShape& shape, const std::vector<Eigen::Vector2d>& profile, const Ray& ray) {
  const auto flat = [&](const Vec3f& v) {
    return Eigen::Vector2d(static_cast<double>(v.dot(shape.along)), static_cast<double>(v.y()));
  };
  const Eigen::Vector2d o = flat(ray.origin), d = flat(ray.direction);
  const double across = static_cast<double>(ray.origin.dot(shape.across)),
               step_across = static_cast<double>(ray.direction.dot(shape.across));
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < profile.size(); ++k) {
    const Eigen::Vector2d edge = profile[k + 1] - profile[k], to = profile[k] - o;
    const double sine = d.x() * edge.y() - d.y() * edge.x();
    const double t = (to.x() * edge.y() - to.y() * edge.x()) / sine, share = (to.x() * d.y() - to.y() * d.x()) / sine;
    if (!(t > 0 && share >= 0 && share <= 1)) continue;
    if (std::abs(across + t * step_across) <= static_cast<double>(shape.half_width)) least = std::min(least, t);
  }
  return least;
}

Ground sweep() {
  Ground ground;
  ground.style = GroundStyle::Sweep;
  ground.height = -0.3f;
  ground.size = 18;
  ground.sweep = 4;
  return ground;
}

Camera oblique_camera() {
  Camera camera;
  camera.position = Vec3f(2, 1.5f, 5);
  camera.target = Vec3f(0, 0.5f, 0);
  return camera;
}

class Rays {
 public:
  Ray next() {
    const auto box = [&](float half) { return Vec3f(Vec3f(at(rng_), at(rng_), at(rng_)) * half); };
    Ray ray;
    ray.origin = box(12);
    ray.direction = box(1).normalized();
    return ray;
  }

 private:
  std::uniform_real_distribution<float> at{-1, 1};
  std::mt19937 rng_{2008};
};

/// A step off the surface and its distance to it, at a point that a ray met.
void expect_on_surface(const SweptGround& ground, const GroundShape& shape, const Ray& ray, const RayHit& hit) {
  const SurfacePoint point = ground.surface_point(hit, ray);
  EXPECT_LT((point.position - (ray.origin + hit.distance * ray.direction)).norm(), 1e-5f * (1 + hit.distance));
  EXPECT_NEAR(point.geometric_normal.norm(), 1, 1e-6f);
  EXPECT_LE(point.geometric_normal.dot(ray.direction), 0) << "towards the viewer";
  EXPECT_EQ(point.shading_normal, point.geometric_normal);
  const Vec3f outer = point.inside ? Vec3f(-point.geometric_normal) : point.geometric_normal;
  const float along = point.position.dot(shape.along), up = point.position.y();
  const Vec2f center(shape.floor_end, shape.height + shape.radius);
  const float rounding = 2e-5f;
  if (along < center.x() || !shape.has_wall) {
    EXPECT_NEAR(up, shape.height, rounding);
    EXPECT_NEAR(outer.y(), 1, rounding);
  } else if (up > center.y()) {
    EXPECT_NEAR(along, center.x() + shape.radius, rounding);
    EXPECT_NEAR(outer.dot(shape.along), -1, rounding);
  } else {
    const Vec2f towards = (center - Vec2f(along, up)).normalized();
    EXPECT_NEAR((center - Vec2f(along, up)).norm(), shape.radius, rounding);
    EXPECT_NEAR(outer.dot(shape.along), towards.x(), rounding);
    EXPECT_NEAR(outer.y(), towards.y(), rounding);
  }
}

/// A ray that starts where one ended does not meet the same place again, on either side.
void expect_left_behind(const SweptGround& ground, const Ray& ray, const RayHit& hit, const Vec3f& random) {
  const SurfacePoint point = ground.surface_point(hit, ray);
  const float up = random.dot(point.geometric_normal);
  const Vec3f away = up < 0 ? Vec3f(-random) : random;
  for (const Ray& next : {Ray{point.lifted, away}, Ray{point.lowered, -away}}) {
    RayHit again;
    if (std::abs(up) < 0.01f || !ground.intersect(next, again)) continue;
    EXPECT_GT(again.distance, 0.015f);
  }
}

/// Rays from everywhere: on both sides of the ground, past its rims, through it twice.
void expect_agreement(const GroundShape& shape, int count) {
  const SweptGround ground(shape);
  const std::vector<Eigen::Vector2d> profile = profile_of(shape);
  Rays rays;
  int hits = 0, misses = 0;
  for (int k = 0; k < count && !testing::Test::HasFailure(); ++k) {
    SCOPED_TRACE(k);
    const Ray ray = rays.next();
    const double expected = nearest(shape, profile, ray);
    RayHit hit;
    const bool found = ground.intersect(ray, hit);
    ASSERT_EQ(found, std::isfinite(expected));
    ASSERT_EQ(ground.blocks(ray), found);
    for (const float end : {0.5f, 2.0f, 8.0f}) {
      if (std::abs(static_cast<double>(end) - expected) < 1e-3) continue;
      ASSERT_EQ(ground.blocks({ray.origin, ray.direction, end, 0}), expected < static_cast<double>(end));
    }
    ++(found ? hits : misses);
    if (!found) continue;
    ASSERT_NEAR(static_cast<double>(hit.distance), expected, 2e-5 * (1 + expected));
    expect_on_surface(ground, shape, ray, hit);
    expect_left_behind(ground, ray, hit, rays.next().direction);
  }
  EXPECT_GT(hits, count / 8);
  EXPECT_GT(misses, count / 8);
}

TEST(SweptGround, MeetsRaysWhereASweepIs) {
  expect_agreement(ground_shape(sweep(), oblique_camera()), 20000);
}

TEST(SweptGround, MeetsRaysWhereAPlaneIs) {
  Ground plane = sweep();
  plane.style = GroundStyle::Plane;
  expect_agreement(ground_shape(plane, oblique_camera()), 20000);
}

TEST(SweptGround, HasNoGapBetweenItsParts) {
  const GroundShape shape = ground_shape(sweep(), oblique_camera());
  const SweptGround ground(shape);
  const Vec3f eye(2, 1.5f, 5);
  const Vec2f floor_end(shape.floor_end, shape.height),
      wall_begin(shape.floor_end + shape.radius, shape.height + shape.radius);
  Rays rays;
  // From low before the joint of a large one, nearly along the floor.
  Ground wide = sweep();
  wide.sweep = 1000;
  wide.size = 4000;
  const GroundShape flat = ground_shape(wide, oblique_camera());
  for (int k = 0; k < 20000; ++k) {
    const Vec3f low = Vec3f(0, flat.height + 1e-3f, 0) + 900 * flat.along;
    RayHit hit;
    const Vec3f target =
        1000.1f * flat.along + Vec3f(0, flat.height, 0) + 0.2f * rays.next().direction.y() * Vec3f(0, 1, 0);
    ASSERT_TRUE(SweptGround(flat).intersect({low, (target - low).normalized()}, hit)) << k;
  }
  for (const Vec2f& joint : {floor_end, wall_begin})
    for (int k = 0; k < 20000; ++k) {
      // Within some units of rounding of the joint, on both sides of it.
      const Vec3f noise = 3e-6f * rays.next().direction;
      const Vec3f target =
          joint.x() * shape.along + Vec3f(0, joint.y(), 0) + 4 * rays.next().direction.x() * shape.across;
      RayHit hit;
      ASSERT_TRUE(ground.intersect({eye, (target + noise - eye).normalized()}, hit)) << k;
      ASSERT_NEAR(hit.distance, (target - eye).norm(), 1e-2f) << k;
    }
}

TEST(SweptGround, IsMetTwiceByALineThroughItsBend) {
  const SweptGround ground(ground_shape(sweep(), oblique_camera()));
  const Vec3f along = Vec3f(-2, 0, -5).normalized();
  // Just inside the arc of radius 2 m about (4 m along, 1.7 m), at 45 degrees.
  const Vec3f deepest = Vec3f(along * (4 + std::sqrt(2.0f)) + Vec3f(0, 1.7f - std::sqrt(2.0f), 0));
  Ray ray;
  ray.direction = (along + Vec3f(0, 1, 0)).normalized();
  const Vec3f inward = (Vec3f(0, 1, 0) - along).normalized();
  ray.origin = deepest + 0.1f * inward - 5 * ray.direction;
  RayHit first, second;
  ASSERT_TRUE(ground.intersect(ray, first));
  const float half_chord = std::sqrt(2 * 2 - 1.9f * 1.9f);
  EXPECT_NEAR(first.distance, 5 - half_chord, 1e-5f);
  ray.origin += (first.distance + 1e-3f) * ray.direction;
  ASSERT_TRUE(ground.intersect(ray, second));
  EXPECT_NEAR(second.distance, 2 * half_chord - 1e-3f, 1e-5f);
}

TEST(MotionBox, HoldsAMeshAtAllItsTimes) {
  MotionMesh mesh = square(1, 0, matte(0.5f));
  mesh.times.push_back(mesh.times.front());
  for (Vec3f& p : mesh.times.back().positions) p += Vec3f(0, 2, 0);
  MotionBox box;
  box.add(mesh);
  Ray ray;
  ray.origin = Vec3f(-5, 1.9f, 0);
  ray.direction = Vec3f(1, 0, 0);
  EXPECT_TRUE(box.may_meet(ray));
  ray.origin.y() = 2.1f;
  EXPECT_FALSE(box.may_meet(ray));
  ray.origin.y() = 2;
  EXPECT_TRUE(box.may_meet(ray)) << "along a face";
  ray.direction = Vec3f(-1, 0, 0);
  EXPECT_FALSE(box.may_meet(ray)) << "behind the ray";
  ray = {Vec3f(0, 9, 0), Vec3f(0, -1, 0), 6.9f, 0};
  EXPECT_FALSE(box.may_meet(ray)) << "beyond the ray's end";
}

}  // namespace
}  // namespace softreel
