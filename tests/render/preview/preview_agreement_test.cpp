/// Where drawn previews show what the path tracer does: lights behind the ground, its edge, lamps, sides of surfaces.
#include <gtest/gtest.h>

#include "tests/render/preview/drawn_preview.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

class PreviewAgreement : public DrawnPreview {};

/// On a white ground, seen from a little above.
Scene on_ground(GroundStyle style) {
  Scene scene = scene_in_sky(0);
  scene.ground.emplace();
  scene.ground->style = style;
  scene.ground->size = 4;
  scene.ground->sweep = 2;
  scene.ground->appearance = matte(0.8f);
  scene.camera.position = Vec3f(0, 1, 4);
  scene.camera.target = Vec3f(0, 0.3f, 0);
  return scene;
}

SunLight sun_from(const Vec3f& towards) {
  SunLight sun;
  sun.direction = -towards.normalized();
  sun.irradiance = Vec3f::Constant(3);
  return sun;
}

/// A small lamp that shines at a point, its centre about as bright there as a sun.
AreaLight lamp_at(const Vec3f& center, const Vec3f& target) {
  AreaLight lamp;
  lamp.center = center;
  const Vec3f forward = (target - center).normalized();
  lamp.u = 0.05f * forward.unitOrthogonal();
  lamp.v = 0.05f * forward.cross(lamp.u.normalized());
  lamp.radiance = Vec3f::Constant(300 * (target - center).squaredNorm());
  lamp.visible = false;
  return lamp;
}

TEST_F(PreviewAgreement, NoLightShinesThroughABackdrop) {
  Scene scene = on_ground(GroundStyle::Sweep);  // its wall stands at z = -3 and ends at a height of 3
  scene.meshes = {sphere(Vec3f(0, 0.4f, 0), 0.3f, matte(0.8f))};
  const Vec3f floor(0.6f, 0, 0.5f), top(0, 0.7f, 0);
  for (const auto& [z, is_lit] : {std::pair(-1.0f, true), std::pair(-5.0f, false)}) {
    scene.area_lights = {lamp_at(Vec3f(0, 2, z), floor)};
    EXPECT_EQ(seen(scene, floor).x() > 50, is_lit) << z;
  }
  scene.area_lights = {lamp_at(Vec3f(0, 0.2f, -2.9f), Vec3f::Zero())};  // behind the bend
  EXPECT_EQ(seen(scene, floor).x(), 0);
  scene.area_lights.clear();
  for (const auto& [towards, is_lit] :
       {std::pair(Vec3f(0, 1, -2), false), std::pair(Vec3f(0, 3, -1), true), std::pair(Vec3f(0, 1, 1), true)}) {
    scene.suns = {sun_from(towards)};
    EXPECT_EQ(seen(scene, floor).x() > 50, is_lit) << towards.transpose();
    EXPECT_EQ(seen(scene, top).x() > 50, is_lit) << towards.transpose();
  }
}

TEST_F(PreviewAgreement, NoLightShinesThroughAFloorButBesideIt) {
  Scene scene = on_ground(GroundStyle::Plane);
  scene.meshes = {square(0.5f, 0.5f, matte(0.8f))};
  scene.camera.position = Vec3f(0, 0.1f, 4);
  scene.camera.target = Vec3f(0, 0.5f, 0);
  const Vec3f underside(0, 0.5f, 0.4f);
  scene.suns = {sun_from(Vec3f(0.1f, -1, 0.2f))};
  EXPECT_EQ(seen(scene, underside).x(), 0);
  scene.suns = {sun_from(Vec3f(9, -1, 0))};  // under the square from beside the ground
  EXPECT_GT(seen(scene, underside).x(), 5);
  scene.suns.clear();
  scene.area_lights = {lamp_at(Vec3f(0, -1, 0), underside)};
  EXPECT_EQ(seen(scene, underside).x(), 0);
  scene.area_lights = {lamp_at(Vec3f(0, 0.2f, 0), underside)};
  EXPECT_GT(seen(scene, underside).x(), 50);
}

TEST_F(PreviewAgreement, APlaneReachesToItsEdges) {
  Scene scene = on_ground(GroundStyle::Plane);
  scene.ground->appearance = matte(0);
  scene.ground->appearance.emission = Vec3f(0.5f, 0, 0);
  scene.camera = camera_above(10, 6);
  const DisplayImage image = draw(scene);
  const auto at = [&](float x, float z) { return pixel_of(image, scene.camera, Vec3f(x, 0, z)).x(); };
  for (const float x : {-1.85f, 0.0f, 1.85f})
    for (const float z : {-1.85f, 0.0f, 1.85f}) EXPECT_NEAR(at(x, z), 127.5f, 1) << x << " " << z;
  for (const float x : {-2.1f, 2.1f}) {
    EXPECT_EQ(at(x, 0), 0);
    EXPECT_EQ(at(0, x), 0);
  }
}

TEST_F(PreviewAgreement, SolesAreNotSeenThroughTheFloorTheyLieIn) {
  Scene scene = on_ground(GroundStyle::Plane);
  scene.ground->appearance = matte(0);
  scene.ground->appearance.emission = Vec3f(0.5f, 0, 0);
  Appearance glowing = matte(0);
  glowing.emission = Vec3f(0, 0.5f, 0);
  scene.meshes = {square(0.5f, 0, glowing)};
  for (const float height : {-1.0f, -3.0f}) {
    scene.camera.position = Vec3f(0.3f, height, 2);
    scene.camera.target = Vec3f::Zero();
    const DisplayImage image = draw(scene);
    for (const float x : {-0.4f, 0.0f, 0.37f})
      for (const float z : {-0.4f, 0.1f, 0.4f})
        EXPECT_EQ(pixel_of(image, scene.camera, Vec3f(x, 0, z)).y(), 0) << height << ": " << x << " " << z;
  }
}

TEST_F(PreviewAgreement, VisibleLampsAreAddedToWhatIsBehindThemOnTheirBrightSide) {
  for (const LampShape shape : {LampShape::Rectangle, LampShape::Disk, LampShape::Sphere}) {
    Scene scene = scene_in_sky(0);
    Appearance glowing = matte(0);
    glowing.emission = Vec3f::Constant(0.2f);
    scene.meshes = {square(0.5f, 0, glowing)};
    scene.camera = camera_above(60, 4);
    AreaLight lamp;
    lamp.shape = shape;
    lamp.center = Vec3f(0.5f, 1, 0);
    lamp.u = Vec3f(0.4f, 0, 0);
    lamp.v = Vec3f(0, 0, -0.4f);  // up, to the camera
    lamp.radiance = Vec3f::Constant(0.4f);
    scene.area_lights = {lamp};
    const auto at = [&](float x) { return seen(scene, Vec3f(x, 1, 0)).x(); };
    EXPECT_NEAR(at(0.3f), 255 * 0.6f, 2) << "before the square";
    EXPECT_NEAR(at(0.7f), 255 * 0.4f, 2);
    EXPECT_EQ(at(1.2f), 0) << "beside it";
    scene.area_lights[0].v = -lamp.v;
    EXPECT_NEAR(at(0.7f), shape == LampShape::Sphere ? 255 * 0.4f : 0.0f, 2) << "from behind";
    scene.area_lights[0] = lamp;
    scene.area_lights[0].center.y() = -1;
    EXPECT_NEAR(at(0.3f), 255 * 0.2f, 2) << "behind the square";
    scene.area_lights[0].visible = false;
    EXPECT_EQ(at(0.7f), 0);
  }
}

TEST_F(PreviewAgreement, FrontsAreFrontsWhereverSmoothNormalsPoint) {
  // The normals of a cube's corners point away from one who looks along its top.
  MotionMesh cube = hard_cube(0.5f, matte(0.8f));
  cube.normal_triangles.clear();
  cube.times[0].normals.clear();
  for (const Vec3f& corner : cube.times[0].positions) cube.times[0].normals.push_back(corner.normalized());
  Scene scene = scene_in_sky(0);
  scene.meshes = {cube};
  scene.suns = {sun_from(Vec3f(0, 1, 0))};
  scene.camera.position = Vec3f(0, 0.9f, 4);
  scene.camera.target = Vec3f(0, 0.5f, 0);
  EXPECT_GT(seen(scene, Vec3f(0.4f, 0.5f, -0.35f)).x(), 60) << "the top's far corner";
  scene.suns = {sun_from(Vec3f(0, -1, 0))};
  EXPECT_EQ(seen(scene, Vec3f(0.4f, 0.5f, -0.35f)).x(), 0);
}

TEST_F(PreviewAgreement, ShadowsFallOnLargeTrianglesBesideManySmallOnes) {
  Scene scene = scene_in_sky(0);
  MotionMesh mesh = square(2, 0, matte(0.8f));
  const MotionMesh ball = sphere(Vec3f(0, 1, 0), 0.3f, matte(0.8f), 100);
  const auto first = static_cast<Index>(mesh.times[0].positions.size());
  for (const Triangle& t : ball.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  MotionMesh::Time& time = mesh.times[0];
  time.positions.insert(time.positions.end(), ball.times[0].positions.begin(), ball.times[0].positions.end());
  time.normals.insert(time.normals.end(), ball.times[0].normals.begin(), ball.times[0].normals.end());
  scene.meshes = {mesh};
  scene.suns = {sun_from(Vec3f(-1, 1, 0))};
  scene.camera = camera_above(10, 4);
  EXPECT_EQ(seen(scene, Vec3f(1, 0, 0)).x(), 0) << "in the ball's shadow";
  EXPECT_GT(seen(scene, Vec3f(1, 0, 0.6f)).x(), 60);
}

TEST_F(PreviewAgreement, WhatHasNoSpecularReflectsNothingAtItsOutline) {
  Scene scene = scene_in_sky(0.6f);
  Appearance black = matte(0);
  black.roughness = 0.1f;
  scene.camera = camera_above(60, 1.2f);
  scene.meshes = {sphere(Vec3f(0, 0, 0), 0.5f, black, 48)};
  EXPECT_LE(seen(scene, Vec3f(0.48f, 0, 0)).x(), 1);
  scene.meshes[0].appearance.specular = 0.5f;
  EXPECT_GT(seen(scene, Vec3f(0.48f, 0, 0)).x(), 20);
}

}  // namespace
}  // namespace softreel
