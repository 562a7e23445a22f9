#include "render/image/view_transform.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(Srgb, DecodesWhatItEncodes) {
  for (int k = 0; k <= 255; ++k) {
    const float encoded = static_cast<float>(k) / 255;
    EXPECT_NEAR(srgb_encode(srgb_decode(encoded)), encoded, 1e-5);
  }
  EXPECT_NEAR(srgb_encode(0.5f), 0.735357, 1e-5) << "IEC 61966-2-1";
}

TEST(Srgb, GivesBytesAsTheCurveDoesToTheLastFloat) {
  const auto expected = [](float x) { return static_cast<int>(std::lround(255 * srgb_encode(x))); };
  for (const float x : {-1.0f, 0.0f, 1e-40f, 1.0f, 2.0f, INFINITY, -INFINITY, NAN})
    EXPECT_EQ(srgb_byte(x), expected(x)) << x;
  for (float x = 1e-5f; x < 1; x *= 1.0001f) ASSERT_EQ(srgb_byte(x), expected(x)) << x;
  for (int code = 0; code < 255; ++code) {  // where the byte changes
    float x = srgb_decode((static_cast<float>(code) + 0.5f) / 255) * (1 - 4e-6f);
    for (int k = 0; k < 120; ++k, x = std::nextafter(x, 2.0f)) ASSERT_EQ(srgb_byte(x), expected(x)) << x;
  }
}

TEST(ApplyView, StandardClipsAndFilmicDoesNot) {
  EXPECT_EQ(apply_view(ViewTransform::Standard, Vec3f(2, 0.5f, -1)), Vec3f(1, 0.5f, 0));
  float before = 0;
  for (float x = 0.05f; x < 100; x *= 1.3f) {
    const float now = apply_view(ViewTransform::Filmic, Vec3f(x, 0.5f * x, 0.1f * x)).x();
    EXPECT_GT(now, before) << "strictly rising at " << x;
    EXPECT_LT(now, 1);
    before = now;
  }
}

TEST(ApplyView, WhatHasNoNumberAnyMoreIsWhite) {
  const float infinite = std::numeric_limits<float>::infinity();
  for (const ViewTransform view : {ViewTransform::Standard, ViewTransform::Filmic, ViewTransform::AcesFit})
    EXPECT_GT(apply_view(view, Vec3f(infinite, infinite, 1)).x(), 0.98f) << static_cast<int>(view);
}

TEST(ApplyView, FilmicIsContinuousAndSmoothAtItsKnee) {
  const auto at = [](float x) { return apply_view(ViewTransform::Filmic, Vec3f::Constant(x)).x(); };
  EXPECT_NEAR(at(0.76f + 1e-4f) - at(0.76f - 1e-4f), 2e-4, 2e-6);
}

TEST(ApplyView, FilmicKeepsTheOrderOfChannelsAndTurnsBrightLightWhite) {
  const Vec3f bright = apply_view(ViewTransform::Filmic, Vec3f(500, 50, 20));
  EXPECT_GT(bright.x(), bright.y());
  EXPECT_GT(bright.y(), bright.z());
  EXPECT_GT(bright.z(), 0.9f);
}

TEST(ApplyView, AcesFitKeepsGreysGreyRisesAndStaysInRange) {
  float before = -1;
  for (float x = 1e-3f; x < 1e9f; x *= 1.5f) {
    const Vec3f grey = apply_view(ViewTransform::AcesFit, Vec3f::Constant(x));
    EXPECT_NEAR(grey.x(), grey.y(), 1e-3f) << x;
    EXPECT_NEAR(grey.z(), grey.y(), 1e-3f) << x;
    EXPECT_GE(grey.y(), before) << x;
    EXPECT_LE(grey.y(), 1) << x;
    before = grey.y();
  }
  EXPECT_EQ(apply_view(ViewTransform::AcesFit, Vec3f::Constant(-1)), apply_view(ViewTransform::AcesFit, Vec3f::Zero()));
  const Vec3f bright = apply_view(ViewTransform::AcesFit, Vec3f(100, 5, 5));
  EXPECT_GT(bright.y(), 0.3f) << "saturated lights turn towards white";
  // The fit at 0.18, by hand: (0.18 (0.18 + 0.0245786) - 0.000090537) / (0.18 (0.983729 0.18 + 0.4329510) + 0.238081).
  EXPECT_NEAR(apply_view(ViewTransform::AcesFit, Vec3f::Constant(0.18f)).y(), 0.10574f, 2e-4f);
}

TEST(ToDisplay, RawHasNoCurve) {
  const Image image{1, 1, {{"R", {0.5f}}, {"G", {-1.0f}}, {"B", {3.0f}}}};
  EXPECT_EQ(to_display(image, ViewTransform::Raw, 0).pixels, (std::vector<std::uint8_t>{128, 0, 255}));
  EXPECT_TRUE(to_display(image, ViewTransform::Raw, 0).linear);
  EXPECT_FALSE(to_display(image, ViewTransform::Standard, 0).linear);
}

TEST(ToDisplay, WhatIsNoNumberIsZeroInEveryViewAndInTheAlpha) {
  const float none = std::numeric_limits<float>::quiet_NaN();
  const Image image{2, 1, {{"R", {none, 0.5f}}, {"G", {1.0f, none}}, {"B", {0.0f, 1.0f}}, {"A", {1.0f, none}}}};
  for (const ViewTransform view : {ViewTransform::Raw, ViewTransform::Standard}) {
    const DisplayImage shown = to_display(image, view, 0);
    EXPECT_EQ(shown.alpha, (std::vector<std::uint8_t>{255, 0}));
    const std::uint8_t half = view == ViewTransform::Raw ? 128 : 188;
    EXPECT_EQ(shown.pixels, (std::vector<std::uint8_t>{0, 255, 0, half, 0, 255}));
  }
  const Image zero{2, 1, {{"R", {0.0f, 0.5f}}, {"G", {1.0f, 0.0f}}, {"B", {0.0f, 1.0f}}, {"A", {1.0f, 0.0f}}}};
  for (const ViewTransform view : {ViewTransform::Filmic, ViewTransform::AcesFit})
    EXPECT_EQ(to_display(image, view, 0).pixels, to_display(zero, view, 0).pixels);
}

TEST(ToDisplay, ExposureCountsInStops) {
  const Image image{1, 1, {{"R", {0.1f}}, {"G", {0.2f}}, {"B", {0.4f}}}};
  const Image doubled{1, 1, {{"R", {0.2f}}, {"G", {0.4f}}, {"B", {0.8f}}}};
  EXPECT_EQ(to_display(image, ViewTransform::Filmic, 1).pixels, to_display(doubled, ViewTransform::Filmic, 0).pixels);
}

}  // namespace
}  // namespace softreel
