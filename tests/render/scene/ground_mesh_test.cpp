#include "render/scene/ground_mesh.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace softreel {
namespace {

Camera camera_from(const Vec3f& position) {
  Camera camera;
  camera.position = position;
  camera.target = Vec3f(0, 0.5f, 0);
  return camera;
}

/// The triangle's own normal against the mean of its vertex normals.
float smallest_agreement(const MotionMesh& mesh) {
  const MotionMesh::Time& time = mesh.times.front();
  float smallest = 1;
  for (const Triangle& t : mesh.triangles) {
    const auto at = [](const std::vector<Vec3f>& v, Index k) { return v[static_cast<std::size_t>(k)]; };
    const Vec3f n = (at(time.positions, t[1]) - at(time.positions, t[0]))
                        .cross(at(time.positions, t[2]) - at(time.positions, t[0]))
                        .normalized();
    for (const Index k : t) smallest = std::min(smallest, n.dot(at(time.normals, k)));
  }
  return smallest;
}

TEST(GroundMesh, PlaneFacesUpAndDoesNotTurnWithTheCamera) {
  Ground ground;
  ground.height = -0.25f;
  const MotionMesh a = ground_mesh(ground, camera_from(Vec3f(0, 1, 4)));
  const MotionMesh b = ground_mesh(ground, camera_from(Vec3f(3, 2, -1)));
  EXPECT_EQ(a.times[0].positions, b.times[0].positions);
  EXPECT_FLOAT_EQ(smallest_agreement(a), 1);
  for (const Vec3f& p : a.times[0].positions) EXPECT_EQ(p.y(), -0.25f);
}

TEST(GroundMesh, SweepRisesBehindTheSubjectAndFacesTheCamera) {
  Ground ground;
  ground.style = GroundStyle::Sweep;
  const Vec3f eye(3, 1, 3);
  const MotionMesh mesh = ground_mesh(ground, camera_from(eye));
  EXPECT_GT(smallest_agreement(mesh), 0.99f);
  const Vec3f away = Vec3f(-1, 0, -1).normalized();
  for (const Vec3f& p : mesh.times[0].positions) {
    EXPECT_LE(p.dot(away), 1.5f * ground.sweep + 1e-3f);
    if (p.y() > 1e-4f) {
      EXPECT_GT(p.dot(away), ground.sweep);
    }
  }
}

TEST(GroundMesh, RefusesGroundWithoutExtent) {
  Ground ground;
  ground.size = 0;
  EXPECT_THROW(ground_mesh(ground, Camera{}), Error);
}

TEST(GroundPattern, AlternatesFromSquareToSquareAndUpTheWall) {
  Ground ground;
  ground.checker = 0.5f;
  const GroundPattern plane(ground, Camera{});
  EXPECT_NE(plane.alternate(Vec3f(0.25f, 0, 0.25f)), plane.alternate(Vec3f(0.75f, 0, 0.25f)));
  EXPECT_EQ(plane.alternate(Vec3f(0.25f, 0, 0.25f)), plane.alternate(Vec3f(0.75f, 0, 0.75f)));
  ground.style = GroundStyle::Sweep;
  ground.sweep = 4;
  const GroundPattern sweep(ground, camera_from(Vec3f(0, 1, 4)));
  // On the wall, 2 m above the end of the arc's quarter circle of radius 2.
  EXPECT_NE(sweep.alternate(Vec3f(0.25f, 4.1f, -6)), sweep.alternate(Vec3f(0.25f, 4.6f, -6)));
}

}  // namespace
}  // namespace softreel
