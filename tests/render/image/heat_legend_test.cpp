#include "render/image/heat_legend.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "render/scene/color_map.h"

namespace softreel {
namespace {

TEST(HeatLegend, TicksAreRoundNumbersEvenlyApartAndWithinTheRange) {
  for (const double high : {1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 7.3, 1e-6, 2.5e9}) {
    const HeatLegend legend = make_heat_legend("Stress", 0, high, {"Pa", 1});
    ASSERT_GE(legend.ticks.size(), 3U) << high;
    EXPECT_LE(legend.ticks.size(), 8U) << high;
    EXPECT_EQ(legend.ticks.front().place, 0);
    const double step = legend.ticks[1].place - legend.ticks[0].place;
    for (std::size_t k = 0; k < legend.ticks.size(); ++k) {
      EXPECT_NEAR(legend.ticks[k].place, static_cast<double>(k) * step, 1e-9);
      EXPECT_NEAR(std::stod(legend.ticks[k].label), legend.ticks[k].place * high, 1e-6 * high + 1e-9) << high;
    }
  }
}

TEST(HeatLegend, LabelsCountInTheUnitOfTheTitle) {
  const HeatLegend legend = make_heat_legend("Strain", 0, 0.2, {"%", 100});
  EXPECT_EQ(legend.title, "Strain, %");
  EXPECT_EQ(legend.ticks.back().label, "20");
  EXPECT_EQ(legend.ticks.back().place, 1);
}

TEST(HeatLegend, ARangeAcrossZeroHasATickAtZero) {
  const HeatLegend legend = make_heat_legend("x", -2, 2, {"m", 1});
  bool zero = false;
  for (const auto& tick : legend.ticks)
    if (tick.place == 0.5) zero = tick.label == "0";
  EXPECT_TRUE(zero);
}

/// 255 times what the picture has at a place.
Vec3f code_at(const DisplayImage& image, int x, int y) {
  const auto at =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {static_cast<float>(image.pixels[at]), static_cast<float>(image.pixels[at + 1]),
          static_cast<float>(image.pixels[at + 2])};
}

TEST(HeatLegend, TheBarShowsTheColoursOfTheSurfaceFromLowToHigh) {
  for (const auto& [width, height] :
       {std::pair(640, 360), std::pair(1920, 1080), std::pair(200, 400), std::pair(64, 48)}) {
    DisplayImage image{width, height, {}};
    image.pixels.assign(static_cast<std::size_t>(3 * width * height), 255);
    draw_heat_legend(make_heat_legend("Strain", 0, 0.5, {"%", 100}), image);
    // In some row the colours of the map follow each other from left to right, over a quarter of the width or more.
    double longest = 0;
    for (int y = 0; y < height / 2; ++y) {
      int lowest = -1, highest = -1;
      for (int x = 0; x < width; ++x) {
        if (lowest < 0 && (code_at(image, x, y) - 255 * heat_code(0)).norm() < 15) lowest = x;
        if ((code_at(image, x, y) - 255 * heat_code(1)).norm() < 15) highest = x;
      }
      if (lowest < 0 || highest < lowest) continue;
      longest = std::max(longest, static_cast<double>(highest - lowest));
      EXPECT_LT((code_at(image, (lowest + highest) / 2, y) - 255 * heat_code(0.5f)).norm(), 20) << width;
    }
    EXPECT_GT(longest, 0.25 * width) << width;
  }
}

TEST(HeatLegend, CoversTheHighestSixthOfThePictureAtMost) {
  DisplayImage image{1280, 720, {}};
  image.pixels.assign(std::size_t{3} * 1280 * 720, 200);
  draw_heat_legend(make_heat_legend("Von Mises stress", 0, 2.5e4, {"kPa", 1e-3}), image);
  for (int y = 120; y < 720; ++y)
    for (int x = 0; x < 1280; ++x) ASSERT_EQ(code_at(image, x, y), Vec3f::Constant(200)) << x << ", " << y;
}

TEST(HeatLegend, ALabelThatWouldRunIntoTheOneBeforeIsLeftOut) {
  DisplayImage one{320, 180, {}};
  one.pixels.assign(std::size_t{3} * 320 * 180, 200);
  DisplayImage two = one;
  HeatLegend legend{"Strain, %", {{0.5, "888"}}};
  draw_heat_legend(legend, one);
  legend.ticks.push_back({0.54, "111"});
  draw_heat_legend(legend, two);
  int columns = 0;
  for (int x = 0; x < 320; ++x) {
    bool differs = false;
    for (int y = 0; y < 180; ++y) differs = differs || code_at(one, x, y) != code_at(two, x, y);
    columns += differs ? 1 : 0;
  }
  EXPECT_GE(columns, 1) << "the mark itself stays";
  EXPECT_LE(columns, 3);
}

TEST(HeatLegend, HasLettersWhereItSaysSo) {
  const HeatLegend words{"Strain, %", {{0.5, "888"}}}, none{"", {}};
  for (const auto& [width, height] :
       {std::pair(160, 120), std::pair(159, 120), std::pair(160, 119), std::pair(64, 64)}) {
    DisplayImage with{width, height, {}};
    with.pixels.assign(static_cast<std::size_t>(3 * width * height), 200);
    DisplayImage without = with;
    draw_heat_legend(words, with);
    draw_heat_legend(none, without);
    EXPECT_EQ(with.pixels != without.pixels, has_legend_letters(width, height)) << width << " x " << height;
  }
  EXPECT_TRUE(has_legend_letters(160, 120));
  EXPECT_FALSE(has_legend_letters(1000, 119));
}

TEST(HeatCode, RunsFromDarkToBrightWithoutTurningBack) {
  const auto brightness = [](float x) { return heat_color(x).dot(Vec3f(0.2126f, 0.7152f, 0.0722f)); };
  float before = -1;
  for (int k = 0; k <= 100; ++k) {
    const float y = brightness(static_cast<float>(k) / 100);
    EXPECT_GT(y, before) << k;
    before = y;
  }
  EXPECT_EQ(heat_code(-3), heat_code(0));
  EXPECT_EQ(heat_code(7), heat_code(1));
  // Of matplotlib's table: its ends and its middle.
  EXPECT_LT((heat_code(0) - Vec3f(0.267004f, 0.004874f, 0.329415f)).norm(), 0.02f);
  EXPECT_LT((heat_code(0.5f) - Vec3f(0.127568f, 0.566949f, 0.550556f)).norm(), 0.02f);
  EXPECT_LT((heat_code(1) - Vec3f(0.993248f, 0.906157f, 0.143936f)).norm(), 0.02f);
}

TEST(VertexBaseColors, AreThoseOfHeatOrOfTheVertices) {
  MotionMesh mesh;
  EXPECT_TRUE(vertex_base_colors(mesh).empty());
  mesh.coloring.colors = {Vec3f(0.1f, 0.2f, 0.3f)};
  EXPECT_EQ(vertex_base_colors(mesh)[0], mesh.coloring.colors[0]);
  mesh.coloring.heat = {0.25f};
  EXPECT_EQ(vertex_base_colors(mesh)[0], heat_color(0.25f));
}

}  // namespace
}  // namespace softreel
