// Geometry of the path tracer: auxiliary channels, lens, shutter.
#include <algorithm>

#include <gtest/gtest.h>

#include "render/pathtrace/path_tracer.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// A black-and-white edge: a glowing half plane x > 0 at a height.
MotionMesh glowing_half_plane(float height) {
  Appearance glowing = matte(0);
  glowing.emission = Vec3f::Ones();
  MotionMesh mesh = square(50, height, glowing);
  for (Vec3f& p : mesh.times[0].positions) p.x() += 50;
  return mesh;
}

TEST(PathTracer, DepthAndNormalOfAPlaneAreExact) {
  Scene scene = scene_in_sky(1);
  scene.meshes = {square(10, 0, matte(0.25f))};
  scene.camera = camera_above(3, 0.3f);
  RenderParams params = small_params(15, 16);
  params.auxiliary = true;
  const Image image = rendered(scene, params);
  const auto center = static_cast<std::size_t>(15 * 7 + 7);
  EXPECT_NEAR(image.find("depth.Z")->pixels[center], 3, 1e-4);
  EXPECT_NEAR(image.find("normal.X")->pixels[center], 0, 1e-6);
  EXPECT_NEAR(image.find("normal.Y")->pixels[center], 1, 1e-6);
  EXPECT_NEAR(image.find("albedo.G")->pixels[center], 0.25, 1e-6);
}

TEST(PathTracer, DepthIsZeroWhereNothingWasHit) {
  Scene scene = scene_in_sky(1);
  scene.camera = camera_above(3, 0.3f);
  RenderParams params = small_params(4, 2);
  params.auxiliary = true;
  const Image image = rendered(scene, params);
  for (const char* name : {"depth.Z", "normal.Y", "albedo.R"})
    for (const float value : image.find(name)->pixels) EXPECT_EQ(value, 0);
  EXPECT_EQ(image.channels.size(), 10u);
}

TEST(PathTracer, PixelsAreSquaresOfTheFilmFromTheTopLeft) {
  // A glowing quarter x > 0, z < 0 (right and up in the picture) fills exactly its quarter.
  Scene scene = scene_in_sky(0);
  MotionMesh quarter = glowing_half_plane(0);
  for (Vec3f& p : quarter.times[0].positions) p.z() -= 50;
  scene.meshes = {quarter};
  scene.camera = camera_above(3, 1);
  const Image image = rendered(scene, small_params(8, 4));
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      EXPECT_EQ(image.channels[0].pixels[static_cast<std::size_t>(8 * y + x)], x >= 4 && y < 4 ? 1 : 0)
          << x << ' ' << y;
}

/// Width in pixels over which the middle row of a picture of an edge rises from 1 % to 99 %.
int edge_width(const Image& image) {
  const auto row = image.channels[0].pixels.begin() + image.height / 2 * image.width;
  return static_cast<int>(std::count_if(row, row + image.width, [](float v) { return v > 0.01f && v < 0.99f; }));
}

TEST(PathTracer, LensKeepsThePlaneOfFocusSharpAndBlursByTheCircleOfConfusion) {
  Scene scene = scene_in_sky(0);
  scene.camera = camera_above(4, 1);
  scene.camera.f_number = 1;
  scene.camera.focus_distance = 2;
  scene.meshes = {glowing_half_plane(2)};
  EXPECT_LE(edge_width(rendered(scene, small_params(64, 64))), 1);
  // In the plane of focus half as far as the subject, the blur of a point is as wide as the lens; the picture is
  // 0.5 m wide there, lens diameter = focal length = 144 mm.
  scene.meshes = {glowing_half_plane(0)};
  const float lens = 0.001f * scene.camera.focal_length_mm;
  const float expected = lens * (4.0f - 2.0f) / 4.0f / 0.5f * 64;
  EXPECT_NEAR(edge_width(rendered(scene, small_params(64, 256))), expected, 2.5f);
}

TEST(PathTracer, LinearMotionCoversInProportionToTime) {
  // The edge moves across the picture while the shutter is open: coverage falls linearly from right to left.
  Scene scene = scene_in_sky(0);
  scene.camera = camera_above(3, 1);
  MotionMesh edge = glowing_half_plane(0);
  for (const int segments : {1, 3}) {
    edge.times.resize(1);
    edge.times.resize(static_cast<std::size_t>(segments) + 1, edge.times[0]);
    for (int k = 0; k <= segments; ++k)
      for (Vec3f& p : edge.times[static_cast<std::size_t>(k)].positions)
        p.x() += (k == 0 ? 0.5f : 0.5f - static_cast<float>(k) / static_cast<float>(segments)) - (k == 0 ? 0 : 0.0f);
    scene.meshes = {edge};
    const Image image = rendered(scene, small_params(16, 256));
    for (int x = 0; x < 16; ++x)
      EXPECT_NEAR(image.channels[0].pixels[static_cast<std::size_t>(16 * 8 + x)], (static_cast<float>(x) + 0.5f) / 16,
                  0.02f)
          << segments << " segments, pixel " << x;
    for (Vec3f& p : edge.times[0].positions) p.x() -= 0.5f;
  }
}

TEST(PathTracer, StaysStillWithoutMotion) {
  // Two equal times are no motion: the picture is that of one time up to the rounding of Embree's interpolation.
  Scene scene = scene_in_sky(0.5f);
  scene.meshes = {sphere(Vec3f::Zero(), 1, matte(0.5f))};
  scene.camera = camera_above(5, 2.5f);
  RenderParams params = small_params(16, 4);
  const Image one = rendered(scene, params);
  scene.meshes[0].times.push_back(scene.meshes[0].times[0]);
  EXPECT_LT(rms_difference(one.channels[0], rendered(scene, params).channels[0]), 0.05);
}

TEST(PathTracer, CoarseSpheresShowNoTerminatorOfTheirTriangles) {
  // Lit from the side, a coarse sphere with smooth normals is as bright as a fine one, to within its outline.
  const auto lit = [](int rows) {
    Scene scene = scene_in_sky(0);
    scene.meshes = {sphere(Vec3f::Zero(), 1, matte(0.8f), rows)};
    SunLight sun;
    sun.direction = Vec3f(-1, 0, 0);
    scene.suns = {sun};
    scene.camera = camera_above(5, 1.0f);
    return rendered(scene, small_params(24, 16));
  };
  const Image coarse = lit(12), fine = lit(96);
  EXPECT_LT(rms_difference(coarse.channels[0], fine.channels[0]), 0.01);
}

}  // namespace
}  // namespace softreel
