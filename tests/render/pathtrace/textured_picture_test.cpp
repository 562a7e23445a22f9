// Textures in traced pictures.
#include <cmath>

#include <gtest/gtest.h>

#include "render/image/texture_pyramid.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

std::shared_ptr<const ColorTexture> checker_colors(int size, int squares) {
  std::vector<Vec3f> texels;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      texels.push_back(Vec3f::Constant((x * squares / size + y * squares / size) % 2 == 0 ? 0.1f : 0.7f));
  return std::make_shared<const ColorTexture>(make_pyramid(size, size, std::move(texels)));
}

/// A floor of edge 2 * half with a texture over all of it.
MotionMesh floor_with(float half, std::shared_ptr<const ColorTexture> texture) {
  MotionMesh mesh = square(half, 0, matte(0.5f));
  mesh.coloring.coordinates = {Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1), Vec2f(0, 1)};
  mesh.coloring.triangles = mesh.triangles;
  mesh.coloring.maps.base_color = std::move(texture);
  return mesh;
}

TEST(TexturedPicture, OfAConstantTextureIsThePictureOfTheConstantColour) {
  Scene plain = scene_in_sky(1);
  plain.camera.position = Vec3f(1.5f, 1.2f, 2);
  plain.camera.target = Vec3f(0, 0.2f, 0);
  Appearance paint;
  paint.base_color = Vec3f(0.31f, 0.62f, 0.117f);
  plain.meshes = {square(1, 0, paint), sphere(Vec3f(0, 0.4f, 0), 0.4f, paint, 12)};
  Scene textured = plain;
  const Vec3f color = paint.base_color;
  for (MotionMesh& mesh : textured.meshes) {
    mesh.appearance.base_color = Vec3f(1, 0, 1);
    mesh.coloring.coordinates.assign(mesh.times[0].positions.size(), Vec2f(0.3f, 0.7f));
    for (std::size_t v = 0; v < mesh.coloring.coordinates.size(); ++v)
      mesh.coloring.coordinates[v] = mesh.times[0].positions[v].head<2>() * 3.3f;
    mesh.coloring.triangles = mesh.triangles;
    mesh.coloring.maps.base_color =
        std::make_shared<const ColorTexture>(make_pyramid(8, 8, std::vector<Vec3f>(64, color)));
  }
  const Image a = rendered(plain, small_params(24, 4)), b = rendered(textured, small_params(24, 4));
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(a.channels[c].pixels, b.channels[c].pixels);
}

/// A checker_colors floor that runs far away, seen at a slant.
Image far_checker(int samples) {
  Scene scene = scene_in_sky(1);
  scene.camera.position = Vec3f(0, 1, 30);
  scene.camera.target = Vec3f(0, 0, 5);
  scene.camera.focal_length_mm = 60;
  scene.meshes = {floor_with(30, checker_colors(1024, 256))};
  RenderParams params = small_params(48, samples);
  params.max_bounces = 1;
  return rendered(scene, params);
}

/// So many samples that each stands for a tiny part of its pixel.
const Image& brute_force() {
  static const Image image = far_checker(1024);
  return image;
}

TEST(TexturedPicture, ACheckerSeenFromAfarHasNoMoireAndAgreesWithBruteForce) {
  const Image one = far_checker(1);
  const Image& reference = brute_force();
  // One unfiltered sample a pixel would be wrong by 0.3 (the spread of the two tones) wherever squares are smaller than
  // pixels, which is nearly everywhere on the floor.
  double floor_pixels = 0;
  for (const float value : reference.channels[0].pixels) floor_pixels += value < 0.9f ? 1 : 0;
  const double unfiltered = 0.3 * std::sqrt(floor_pixels / (48 * 48));
  EXPECT_LT(rms_difference(one.channels[0], reference.channels[0]), 0.35 * unfiltered);
  // Distant rows: squares far below a pixel show their mean.
  double worst = 0;
  for (int x = 0; x < 48; ++x) {
    int y = 0;
    while (reference.channels[0].pixels[static_cast<std::size_t>(y * 48 + x)] > 0.9f) ++y;  // the sky
    const auto at = static_cast<std::size_t>((y + 1) * 48 + x);
    worst = std::max(worst, std::abs(static_cast<double>(one.channels[0].pixels[at]) - 0.4));
  }
  EXPECT_LT(worst, 0.03);
}

TEST(TexturedPicture, HasTheSameBitsOnOneAndTwoThreads) {
  Scene scene = scene_in_sky(1);
  scene.camera.position = Vec3f(1.5f, 1.2f, 2);
  scene.meshes = {floor_with(2, checker_colors(64, 8)), sphere(Vec3f(0, 0.4f, 0), 0.4f, matte(0.5f), 12)};
  for (const Vec3f& p : scene.meshes[1].times[0].positions) scene.meshes[1].coloring.heat.push_back(p.y());
  const Image one = rendered(scene, small_params(40, 4), 1), two = rendered(scene, small_params(40, 4), 2);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(one.channels[c].pixels, two.channels[c].pixels);
}

TEST(TexturedPicture, ApproachesBruteForceAsSamplesGrow) {
  const Image& reference = brute_force();
  double before = 1e300;
  for (const int samples : {1, 8, 64}) {
    const double error = rms_difference(far_checker(samples).channels[0], reference.channels[0]);
    EXPECT_LT(error, 0.6 * before) << samples;
    before = error;
  }
}

TEST(TexturedPicture, AcrossASeamOfCoordinatesThereIsNoLine) {
  // Two halves whose coordinates are the same picture continued: left 0 to 1, right 5 to 6; neither blurs the jump.
  Scene scene = scene_in_sky(1);
  scene.camera = camera_above(3, 1);
  MotionMesh mesh;
  mesh.appearance = matte(0.5f);
  mesh.times.resize(1);
  mesh.times[0].positions = {Vec3f(-1, 0, 1),  Vec3f(0, 0, 1), Vec3f(0, 0, -1),
                             Vec3f(-1, 0, -1), Vec3f(1, 0, 1), Vec3f(1, 0, -1)};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  mesh.coloring.coordinates = {Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1), Vec2f(0, 1),
                               Vec2f(5, 0), Vec2f(6, 0), Vec2f(6, 1), Vec2f(5, 1)};
  mesh.coloring.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  std::vector<Vec3f> texels;
  for (int k = 0; k < 64 * 64; ++k)
    texels.push_back(Vec3f::Constant(0.5f + 0.3f * static_cast<float>(std::cos(2 * M_PI * (k % 64 + 0.5) / 64))));
  mesh.coloring.maps.base_color = std::make_shared<const ColorTexture>(make_pyramid(64, 64, std::move(texels)));
  scene.meshes = {mesh};
  RenderParams params = small_params(32, 256);
  params.max_bounces = 1;
  const Image image = rendered(scene, params);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const double place = (x + 0.5) / 32 - 0.5;  // metres from the seam
      const double wanted = 0.5 + 0.3 * std::cos(2 * M_PI * place);
      EXPECT_NEAR(image.channels[0].pixels[static_cast<std::size_t>(32 * y + x)], wanted, 0.01) << x;
    }
}

}  // namespace
}  // namespace softreel
