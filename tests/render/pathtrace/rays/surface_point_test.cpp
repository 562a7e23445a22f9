#include "render/pathtrace/rays/surface_point.h"

#include <algorithm>

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

/// A box of twelve triangles with edges of 2 m, whose normals are averaged at its corners.
MotionMesh rounded_box() {
  MotionMesh mesh;
  mesh.times.resize(1);
  for (int k = 0; k < 8; ++k) {
    const Vec3f corner(k & 1 ? 1.0f : -1.0f, k & 2 ? 1.0f : -1.0f, k & 4 ? 1.0f : -1.0f);
    mesh.times[0].positions.push_back(corner);
    mesh.times[0].normals.push_back(corner.normalized());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// The middle of a triangle, seen from outside or from inside.
SurfacePoint middle_of(const MotionMesh& mesh, Index triangle, bool from_inside) {
  RayHit hit;
  hit.mesh = 0;
  hit.triangle = triangle;
  hit.u = hit.v = 1.0f / 3;
  const Corners p = hit_corners(mesh, hit, Ray{});
  const Vec3f normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
  Ray ray;
  ray.direction = from_inside ? normal : Vec3f(-normal);
  return surface_point(mesh, hit, ray);
}

TEST(SurfacePoint, StaysOnTheFlatFacesOfABoxWithAveragedNormals) {
  const MotionMesh box = rounded_box();
  for (Index t = 0; t < 12; ++t)
    for (const bool from_inside : {false, true}) {
      const SurfacePoint point = middle_of(box, t, from_inside);
      EXPECT_LT((point.lifted - point.position).norm(), 0.01f * 2) << t;
    }
}

TEST(SurfacePoint, LiftsAsHanikaDoesOnAFineSphere) {
  const MotionMesh ball = sphere(Vec3f::Zero(), 1, matte(0.5f), 24);
  for (std::size_t t = 0; t < ball.triangles.size(); t += 7) {
    const SurfacePoint point = middle_of(ball, static_cast<Index>(t), false);
    Vec3f expected = point.position;
    for (const Index corner : ball.triangles[t]) {
      const auto k = static_cast<std::size_t>(corner);
      const Vec3f& n = ball.times[0].normals[k];
      expected += std::max(0.0f, (ball.times[0].positions[k] - point.position).dot(n)) / 3 * n;
    }
    EXPECT_LT((point.lifted - expected).norm(), 1.2e-5f) << "but for the margin of rounding";
    EXPECT_GT((point.lifted - point.position).norm(), 5e-4f) << "of the sphere's own bulge";
  }
}

}  // namespace
}  // namespace softreel
