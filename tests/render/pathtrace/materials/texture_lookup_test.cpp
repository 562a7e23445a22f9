#include "render/pathtrace/materials/texture_lookup.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "render/image/texture_pyramid.h"
#include "render/pathtrace/rays/ray_cone.h"

namespace softreel {
namespace {

TextureFootprint disk(float u, float v, float radius) {
  return {Vec2f(u, v), Vec2f(radius, 0), Vec2f(0, radius)};
}

/// Black and white squares, `squares` of them along an edge.
DataTexture checker(int size, int squares) {
  std::vector<float> texels;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) texels.push_back(static_cast<float>((x * squares / size + y * squares / size) % 2));
  return make_pyramid(size, size, std::move(texels));
}

DataTexture noise(int width, int height) {
  std::mt19937 random(3);
  std::vector<float> texels;
  for (int k = 0; k < width * height; ++k) texels.push_back(static_cast<float>(random()) / 4294967296.0f);
  return make_pyramid(width, height, std::move(texels));
}

TEST(LookUp, GivesTexelsAtTheirCentresAndTheMiddleBetweenThem) {
  const DataTexture texture = make_pyramid(2, 2, std::vector<float>{1, 2, 3, 4});
  EXPECT_FLOAT_EQ(look_up(texture, TextureWrap::Clamp, disk(0.25f, 0.75f, 0)), 1) << "v is upward, row 0 on top";
  EXPECT_FLOAT_EQ(look_up(texture, TextureWrap::Clamp, disk(0.75f, 0.25f, 0)), 4);
  EXPECT_FLOAT_EQ(look_up(texture, TextureWrap::Clamp, disk(0.5f, 0.75f, 0)), 1.5f);
}

TEST(LookUp, WrapsAsAsked) {
  const DataTexture texture = make_pyramid(4, 1, std::vector<float>{1, 2, 3, 4});
  const auto at = [&](TextureWrap wrap, float u) { return look_up(texture, wrap, disk(u, 0.5f, 0)); };
  for (const float whole : {-6.0f, 0.0f, 2.0f, 40.0f}) {
    EXPECT_NEAR(at(TextureWrap::Repeat, whole + 0.125f), 1, 1e-5);
    EXPECT_NEAR(at(TextureWrap::Repeat, whole + 1.375f), 2, 1e-5);
    EXPECT_NEAR(at(TextureWrap::Repeat, whole), 2.5, 1e-4) << "the seam blends both ends";
    EXPECT_NEAR(at(TextureWrap::Mirror, whole + 0.375f), 2, 1e-5);
    EXPECT_NEAR(at(TextureWrap::Mirror, whole + 1.375f), 3, 1e-5);
  }
  EXPECT_FLOAT_EQ(at(TextureWrap::Clamp, -7), 1);
  EXPECT_FLOAT_EQ(at(TextureWrap::Clamp, 9), 4);
}

TEST(LookUp, OfEqualTexelsIsExactlyTheirValueUnderAnyFootprint) {
  const Vec3f color(0.1f, 0.37f, 0.9123f);
  const ColorTexture texture = make_pyramid(37, 22, std::vector<Vec3f>(37 * 22, color));
  std::mt19937 random(11);
  std::uniform_real_distribution<float> any(-1, 1);
  for (int k = 0; k < 500; ++k) {
    const float size = std::pow(10.0f, 2 * any(random) - 1);
    const TextureFootprint footprint{Vec2f(5 * any(random), 5 * any(random)), size * Vec2f(any(random), any(random)),
                                     size * Vec2f(any(random), any(random))};
    for (const TextureWrap wrap : {TextureWrap::Repeat, TextureWrap::Clamp, TextureWrap::Mirror})
      EXPECT_EQ(look_up(texture, wrap, footprint), color);
  }
}

TEST(LookUp, KeepsTheMeanAtEveryFootprint) {
  const DataTexture texture = noise(48, 40);
  const double mean = static_cast<double>(texture.levels.back().texels[0]);
  for (const float radius : {0.0f, 0.01f, 0.03f, 0.1f, 0.3f, 2.0f}) {
    double sum = 0;
    constexpr int kSide = 240;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        sum += static_cast<double>(
            look_up(texture, TextureWrap::Repeat,
                    disk((static_cast<float>(x) + 0.5f) / kSide, (static_cast<float>(y) + 0.5f) / kSide, radius)));
    EXPECT_NEAR(sum / (kSide * kSide), mean, 2e-4) << radius;
  }
}

TEST(LookUp, WideFootprintsOfACheckerSeeItsMean) {
  const DataTexture texture = checker(256, 64);  // squares of 4 texels
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(0, 1);
  for (int k = 0; k < 200; ++k) {
    EXPECT_NEAR(look_up(texture, TextureWrap::Repeat, disk(any(random), any(random), 0.05f)), 0.5f, 1e-5f);
    // Narrow, but long across many squares: its probes do not wash out the other direction's squares to either value.
    const TextureFootprint streak{Vec2f(any(random), any(random)), Vec2f(0.12f, 0.05f), Vec2f(0.0005f, 0.001f)};
    EXPECT_NEAR(look_up(texture, TextureWrap::Repeat, streak), 0.5f, 0.2f);
  }
}

TEST(LookUp, LongFootprintsBlurAlongTheirLengthOnly) {
  // Stripes across u: a streak along v sees one stripe, one along u sees all.
  std::vector<float> texels;
  for (int k = 0; k < 128 * 128; ++k) texels.push_back(static_cast<float>(k % 128 / 16 % 2));
  const DataTexture texture = make_pyramid(128, 128, std::move(texels));
  const Vec2f at(24.0f / 128, 0.4f);
  const TextureFootprint along{at, Vec2f(0, 0.06f), Vec2f(0.004f, 0)}, across{at, Vec2f(0.25f, 0), Vec2f(0, 0.016f)};
  EXPECT_NEAR(look_up(texture, TextureWrap::Repeat, along), 1, 1e-5);
  EXPECT_NEAR(look_up(texture, TextureWrap::Repeat, across), 0.5, 0.05);
}

TEST(LookUpSlope, OfAPlaneIsItsSlope) {
  std::vector<float> texels;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) texels.push_back(0.01f * static_cast<float>(x) - 0.02f * static_cast<float>(y));
  const DataTexture texture = make_pyramid(64, 64, std::move(texels));
  for (const float radius : {0.0f, 0.02f, 0.08f}) {
    const Vec2f slope = look_up_slope(texture, TextureWrap::Clamp, disk(0.5f, 0.5f, radius));
    EXPECT_NEAR(slope.x(), 0.64, 5e-3) << radius;
    EXPECT_NEAR(slope.y(), 1.28, 5e-3) << radius << ": v is upward";
  }
}

TEST(ConeFootprint, IsThePixelOnAPlaneSeenHeadOnAndLongerAtASlant) {
  // A square of 2 m with coordinates from 0 to 1: half a coordinate a metre.
  const Corners p{Vec3f(-1, 0, 1), Vec3f(1, 0, 1), Vec3f(1, 0, -1)};
  const TextureGradients gradients(p, {Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1)});
  EXPECT_TRUE(gradients.du.isApprox(Vec3f(0.5f, 0, 0)));
  EXPECT_TRUE(gradients.dv.isApprox(Vec3f(0, 0, -0.5f)));
  const Vec3f up(0, 1, 0);
  const TextureFootprint head_on = cone_footprint(gradients, Vec2f(0, 0), -up, up, 0.2f);
  EXPECT_NEAR(head_on.a.norm(), 0.05, 1e-6);
  EXPECT_NEAR(head_on.b.norm(), 0.05, 1e-6);
  EXPECT_NEAR(head_on.a.dot(head_on.b), 0, 1e-7);
  const float angle = 1.2f;  // from the normal
  const Vec3f slant(std::sin(angle), -std::cos(angle), 0);
  const TextureFootprint longer = cone_footprint(gradients, Vec2f(0, 0), slant, up, 0.2f);
  EXPECT_NEAR(std::abs(longer.a.x()), 0.05 / std::cos(angle), 1e-5);
  EXPECT_NEAR(longer.b.norm(), 0.05, 1e-6);
}

TEST(RayCone, GrowsWithDistanceAndOpensWithTheWidthOfAScattering) {
  const RayCone camera{0, 0.001f};
  EXPECT_FLOAT_EQ(camera.width_at(5), 0.005f);
  const RayCone mirrored = camera.scattered(5, 0, 16);
  EXPECT_FLOAT_EQ(mirrored.width_at(5), 0.01f) << "a flat mirror changes nothing";
  const RayCone narrow = camera.scattered(5, 1000, 16), wide = camera.scattered(5, 0.3f, 16);
  EXPECT_GT(narrow.width_at(1), mirrored.width_at(1));
  EXPECT_GT(wide.width_at(1), narrow.width_at(1));
  EXPECT_GT(wide.width_at(1), camera.scattered(5, 0.3f, 1024).width_at(1)) << "more samples: smaller shares";
}

}  // namespace
}  // namespace softreel
