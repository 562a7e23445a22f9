#include "render/pathtrace/surface_point.h"

#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

Ray ray_down(const Vec3f& from, float time = 0) {
  Ray ray;
  ray.origin = from;
  ray.direction = Vec3f(0, -1, 0);
  ray.time = time;
  return ray;
}

TEST(SurfacePoint, TurnsNormalsTowardsTheViewer) {
  const MotionMesh floor = square(1, 0, matte(0.5f));
  RayHit hit;
  hit.mesh = hit.triangle = 0;
  hit.u = hit.v = 0.3f;
  const SurfacePoint above = surface_point(floor, hit, ray_down(Vec3f(0, 1, 0)));
  EXPECT_FALSE(above.inside);
  EXPECT_EQ(above.shading_normal, Vec3f(0, 1, 0));
  Ray up = ray_down(Vec3f(0, -1, 0));
  up.direction = Vec3f(0, 1, 0);
  const SurfacePoint below = surface_point(floor, hit, up);
  EXPECT_TRUE(below.inside);
  EXPECT_EQ(below.geometric_normal, Vec3f(0, -1, 0));
  EXPECT_LT(below.lifted.y(), 0);
}

TEST(SurfacePoint, MovesCornersOnStraightPiecesBetweenTimes) {
  MotionMesh floor = square(1, 0, matte(0.5f));
  floor.times.resize(3, floor.times[0]);
  for (Vec3f& p : floor.times[1].positions) p.y() = 1;
  for (Vec3f& p : floor.times[2].positions) p.y() = 5;
  RayHit hit;
  hit.mesh = hit.triangle = 0;
  hit.u = hit.v = 0.3f;
  EXPECT_FLOAT_EQ(surface_point(floor, hit, ray_down(Vec3f(0, 9, 0), 0.25f)).position.y(), 0.5f);
  EXPECT_FLOAT_EQ(surface_point(floor, hit, ray_down(Vec3f(0, 9, 0), 0.5f)).position.y(), 1);
  EXPECT_FLOAT_EQ(surface_point(floor, hit, ray_down(Vec3f(0, 9, 0), 0.75f)).position.y(), 3);
}

TEST(SurfacePoint, LiftsOntoTheRoundSurfaceButNotOffAFlatOne) {
  const MotionMesh floor = square(1, 0, matte(0.5f));
  RayHit hit;
  hit.mesh = hit.triangle = 0;
  hit.u = hit.v = 0.3f;
  EXPECT_LT(surface_point(floor, hit, ray_down(Vec3f(0, 1, 0))).lifted.y(), 1e-4f);
  const MotionMesh ball = sphere(Vec3f::Zero(), 1, matte(0.5f), 8);
  hit.triangle = 40;
  const SurfacePoint point = surface_point(ball, hit, ray_down(Vec3f(0, 2, 0)));
  EXPECT_GT(point.lifted.norm(), point.position.norm() + 1e-3f);
  EXPECT_LT(point.lifted.norm(), 1.02f);
}

}  // namespace
}  // namespace softreel
