#include "render/pathtrace/rays/edge_lines.h"

#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// Share of the picture that shows lines on a white square of 0.2 m, on 60 pixels that are 0.3 m: 5 mm each. The camera
/// is far above, so that the picture is as good as parallel.
double line_share(const EdgeLines& lines, float half = 0.1f, int samples = 64) {
  Scene scene = scene_in_sky(1);
  MotionMesh white = square(half, 0, matte(1));
  white.lines = lines;
  scene.meshes = {white};
  scene.camera = camera_above(30, 0.3f);
  RenderParams params = small_params(60, samples);
  params.auxiliary = true;
  const Image image = rendered(scene, params);
  const double pixels = 60 * 60, covered = std::pow(2 * static_cast<double>(half) / 0.005, 2);
  return (covered - pixels * mean_of(*image.find("albedo.G"))) / pixels;
}

constexpr std::uint8_t kRim = 0b011, kSecondRim = 0b110;  ///< of the two triangles of a square: all but the diagonal

TEST(EdgeLines, AreAsManyPixelsWideAsAskedHalfOnEitherSide) {
  EdgeLines lines;
  lines.width = 3;
  lines.max_share = 1;
  lines.drawn = {kRim, kSecondRim};
  const double rim = 1 - std::pow((40 - 3.0) / 40, 2);  // 1.5 pixels inside of each side
  EXPECT_NEAR(line_share(lines), rim * 1600 / 3600, 0.002);
  lines.drawn = {};  // the diagonal too: 3 pixels wide; where it leaves the rim's inner square it is cut slantwise
  const double diagonal = (37 * std::sqrt(2.0) * 3 - 3 * 3 / 2.0) / 1600;
  EXPECT_NEAR(line_share(lines), (rim + diagonal) * 1600 / 3600, 0.002);
  lines.drawn = {0, 0};
  EXPECT_NEAR(line_share(lines), 0, 1e-6);
}

TEST(EdgeLines, TakeAtMostTheirShareOfATriangle) {
  EdgeLines lines;
  lines.width = 100;
  lines.max_share = 0.25f;
  // All points nearer to a side than a quarter of the inscribed circle: the rest is similar with three quarters.
  EXPECT_NEAR(line_share(lines), (1 - 0.75 * 0.75) * 1600 / 3600, 0.002);
}

TEST(EdgeLines, FadeWhereTrianglesAreSmallerThanAPixel) {
  EdgeLines lines;
  lines.width = 100;
  lines.max_share = 0.25f;
  const float half = 0.0025f;  // one pixel: the inscribed circles have the radius 1 / (2 + sqrt 2)
  const double share = 0.25 / (2 + std::sqrt(2.0));
  EXPECT_NEAR(line_share(lines, half, 512) * 3600, 1 - std::pow(1 - share, 2), 0.02);
}

TEST(EdgeLines, AreSeenByTheCameraOnly) {
  // A white floor under the square sees it from below: with lines or without, it gets the same light.
  Scene scene = scene_in_sky(1);
  MotionMesh lid = square(0.1f, 1, matte(1));
  scene.meshes = {square(5, 0, matte(0.5f)), lid};
  scene.camera = camera_above(30, 2);
  const RenderParams params = small_params(64, 16);
  const Image without = rendered(scene, params);
  scene.meshes[1].lines.emplace().width = 1e6f;
  scene.meshes[1].lines->max_share = 1;
  const Image with = rendered(scene, params);
  const auto floor = static_cast<std::size_t>(64 * 32 + 8);
  EXPECT_EQ(with.find("G")->pixels[floor], without.find("G")->pixels[floor]);
  const auto middle = static_cast<std::size_t>(64 * 32 + 32);
  EXPECT_EQ(with.find("G")->pixels[middle], 0);
  EXPECT_GT(without.find("G")->pixels[middle], 0.9f);
}

}  // namespace
}  // namespace softreel
