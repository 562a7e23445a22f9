// The ground by arithmetic against its triangles one by one.
#include "render/pathtrace/rays/swept_ground.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "render/pathtrace/rays/scene_rays.h"
#include "render/scene/ground_mesh.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

Eigen::Vector3d corner(const MotionMesh& mesh, std::size_t triangle, std::size_t k) {
  return mesh.times[0].positions[static_cast<std::size_t>(mesh.triangles[triangle][k])].cast<double>();
}

/// Nearest meeting with a triangle, in double; infinite if none.
double nearest(const MotionMesh& mesh, const Ray& ray) {
  const Eigen::Vector3d o = ray.origin.cast<double>(), d = ray.direction.cast<double>();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Eigen::Matrix3d columns;
    columns << corner(mesh, t, 1) - corner(mesh, t, 0), corner(mesh, t, 2) - corner(mesh, t, 0), -d;
    const Eigen::Vector3d x = columns.partialPivLu().solve(o - corner(mesh, t, 0));
    if (x[0] >= -1e-9 && x[1] >= -1e-9 && x[0] + x[1] <= 1 + 1e-9 && x[2] > 0) least = std::min(least, x[2]);
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

/// Rays from everywhere: on both sides of the ground, past its rims, through it twice.
void expect_agreement(const MotionMesh& mesh, int count) {
  const SweptGround ground(mesh);
  Rays rays;
  int hits = 0, misses = 0;
  for (int k = 0; k < count; ++k) {
    const Ray ray = rays.next();
    const double expected = nearest(mesh, ray);
    RayHit hit;
    const bool found = ground.intersect(ray, hit);
    ASSERT_EQ(found, std::isfinite(expected)) << k;
    ASSERT_EQ(ground.blocks(ray), found) << k;
    for (const float end : {0.5f, 2.0f, 8.0f}) {
      if (std::abs(static_cast<double>(end) - expected) < 1e-3) continue;
      ASSERT_EQ(ground.blocks({ray.origin, ray.direction, end, 0}), expected < static_cast<double>(end)) << k;
    }
    ++(found ? hits : misses);
    if (!found) continue;
    ASSERT_NEAR(static_cast<double>(hit.distance), expected, 2e-5 * (1 + expected)) << k;
    ASSERT_GE(hit.u, 0);
    ASSERT_GE(hit.v, 0);
    ASSERT_LE(hit.u + hit.v, 1 + 1e-6f);
    const auto triangle = static_cast<std::size_t>(hit.triangle);
    ASSERT_LT(triangle, mesh.triangles.size());
    const double u = static_cast<double>(hit.u), v = static_cast<double>(hit.v);
    const Eigen::Vector3d place =
        (1 - u - v) * corner(mesh, triangle, 0) + u * corner(mesh, triangle, 1) + v * corner(mesh, triangle, 2);
    const Eigen::Vector3d met = ray.origin.cast<double>() + expected * ray.direction.cast<double>();
    ASSERT_LT((place - met).norm(), 1e-4) << k << ": the triangle's point is where the ray is";
  }
  EXPECT_GT(hits, count / 8);
  EXPECT_GT(misses, count / 8);
}

TEST(SweptGround, MeetsRaysWhereTheTrianglesOfASweepAre) {
  expect_agreement(ground_mesh(sweep(), oblique_camera(), 3), 4000);
}

TEST(SweptGround, MeetsRaysWhereTheTrianglesOfAPlaneAre) {
  Ground plane = sweep();
  plane.style = GroundStyle::Plane;
  expect_agreement(ground_mesh(plane, oblique_camera()), 4000);
}

TEST(SweptGround, IsMetTwiceByALineThroughItsBend) {
  const MotionMesh mesh = ground_mesh(sweep(), oblique_camera(), 3);
  const SweptGround ground(mesh);
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
  EXPECT_NEAR(first.distance, 5 - half_chord, 0.01f);
  ray.origin += (first.distance + 1e-3f) * ray.direction;
  ASSERT_TRUE(ground.intersect(ray, second));
  EXPECT_NEAR(second.distance, 2 * half_chord, 0.01f);
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
