/// Bodies whose vertices have a normal for each of the smooth parts that meet there.
#include <gtest/gtest.h>

#include "render/image/texture_pyramid.h"
#include "render/pathtrace/materials/albedo_cache.h"
#include "render/pathtrace/materials/colored_surface.h"
#include "render/pathtrace/rays/surface_point.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// A place of a triangle, seen from right before it.
SurfacePoint surface_at(const MotionMesh& mesh, Index triangle, float u, float v,
                        const ColoredSurface* colored = nullptr) {
  RayHit hit;
  hit.mesh = 0;
  hit.triangle = triangle;
  hit.u = u;
  hit.v = v;
  hit.distance = 1;
  const Corners p = hit_corners(mesh, hit, Ray{});
  Ray ray;
  ray.direction = -(p[1] - p[0]).cross(p[2] - p[0]).normalized();
  SurfacePoint point = surface_point(mesh, hit, ray);
  if (colored != nullptr) colored->at(hit, ray, 0.01f, false, point);
  return point;
}

TEST(HardEdges, LeaveSidesFlatUpToTheirCorners) {
  const MotionMesh cube = hard_cube(1, matte(0.5f));
  for (Index t = 0; t < 12; ++t)
    for (const auto& [u, v] : {std::pair(0.0f, 0.0f), {1.0f, 0.0f}, {0.0f, 1.0f}, {0.3f, 0.3f}}) {
      const SurfacePoint point = surface_at(cube, t, u, v);
      EXPECT_EQ(point.shading_normal, point.geometric_normal) << t;
      EXPECT_LT((point.lifted - point.position).norm(), 2e-5f) << "but for the margin of rounding";
    }
}

TEST(HardEdges, MoveWithTheSurfaceWhileTheShutterIsOpen) {
  MotionMesh cube = hard_cube(1, matte(0.5f));
  cube.times.push_back(cube.times[0]);
  for (Vec3f& n : cube.times[1].normals) n = (n + Vec3f(0, 0, 0.25f)).normalized();
  RayHit hit;
  hit.mesh = 0;
  hit.triangle = 6;  // of the upper side
  Ray ray;
  ray.direction = Vec3f(0, -1, 0);
  ray.time = 0.5f;
  const Vec3f half = (Vec3f::UnitY() + cube.times[1].normals[3]).normalized();
  EXPECT_LT((surface_point(cube, hit, ray).shading_normal - half).norm(), 1e-6f);
}

TEST(HardEdges, OfACubeHaveTheNormalsOfItsSidesInThePicture) {
  Scene scene = scene_in_sky(1);
  scene.camera = camera_above(4, 0.9f);
  scene.meshes = {hard_cube(0.5f, matte(0.5f))};
  RenderParams params = small_params(16, 4);
  params.channels.add(PictureChannel::Normal);
  const Image hard = rendered(scene, params);
  EXPECT_EQ(hard.find("normal.X")->pixels, std::vector<float>(256, 0));
  EXPECT_EQ(hard.find("normal.Y")->pixels, std::vector<float>(256, 1));
  EXPECT_EQ(hard.find("normal.Z")->pixels, std::vector<float>(256, 0));
  MotionMesh& cube = scene.meshes.front();
  cube.normal_triangles = {};
  cube.times[0].normals = {};
  for (const Vec3f& corner : cube.times[0].positions) cube.times[0].normals.push_back(corner.normalized());
  EXPECT_LT(rendered(scene, params).find("normal.Y")->pixels.front(), 0.8f) << "one normal a corner makes a pillow";
}

TEST(HardEdges, PartTheDirectionsOfNormalMapsToo) {
  // Two squares with a common edge from (0, 0, 1) to (0, 0, -1), where they meet at 90 degrees; u runs across it.
  MotionMesh roof;
  roof.times.resize(1);
  roof.times[0].positions = {Vec3f(-1, -1, 1),  Vec3f(0, 0, 1),  Vec3f(0, 0, -1),
                             Vec3f(-1, -1, -1), Vec3f(1, -1, 1), Vec3f(1, -1, -1)};
  const float half = std::sqrt(0.5f);
  roof.times[0].normals = {Vec3f(-half, half, 0), Vec3f(half, half, 0)};
  roof.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  roof.normal_triangles = {{0, 0, 0}, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}};
  roof.coloring.coordinates = {Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1), Vec2f(0, 1), Vec2f(2, 0), Vec2f(2, 1)};
  roof.coloring.triangles = roof.triangles;
  roof.coloring.maps.normal =
      std::make_shared<const ColorTexture>(make_pyramid(4, 4, std::vector<Vec3f>(16, Vec3f(0.28f, 0, 0.96f))));
  AlbedoCache tables;
  const ColoredSurface colored(roof, 0, tables);
  const std::array<Vec3f, 2> along_u{Vec3f(half, half, 0), Vec3f(half, -half, 0)};
  for (Index t = 0; t < 4; ++t)
    for (const auto& [u, v] : {std::pair(0.01f, 0.01f), {0.98f, 0.01f}, {0.01f, 0.98f}}) {
      const auto side = static_cast<std::size_t>(t / 2);
      const Vec3f tilted = 0.28f * along_u[side] + 0.96f * roof.times[0].normals[side];
      EXPECT_LT((surface_at(roof, t, u, v, &colored).shading_normal - tilted).norm(), 1e-5f) << t;
    }
}

}  // namespace
}  // namespace softreel
