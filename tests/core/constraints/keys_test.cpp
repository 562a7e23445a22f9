#include "core/constraints/keys.h"

#include <numbers>

#include <gtest/gtest.h>

namespace softreel {
namespace {

Track<double> ramp(Ease ease) {
  return {{{10, 0.0, ease}, {20, 1.0, Ease::Linear}, {30, -1.0, Ease::Linear}}};
}

TEST(Track, HoldsItsEndsAndMeetsItsKeys) {
  for (const Ease ease : {Ease::Constant, Ease::Linear, Ease::Smooth}) {
    const Track<double> track = ramp(ease);
    EXPECT_EQ(track.at(-5), 0.0);
    EXPECT_EQ(track.at(10), 0.0);
    EXPECT_EQ(track.at(20), 1.0);
    EXPECT_EQ(track.at(30), -1.0);
    EXPECT_EQ(track.at(99), -1.0);
  }
}

TEST(Track, EachKeysEaseGovernsTheSegmentThatItStarts) {
  EXPECT_EQ(ramp(Ease::Constant).at(19.999), 0.0);
  EXPECT_DOUBLE_EQ(ramp(Ease::Linear).at(12.5), 0.25);
  EXPECT_DOUBLE_EQ(ramp(Ease::Smooth).at(15), 0.5);
  EXPECT_DOUBLE_EQ(ramp(Ease::Constant).at(25), 0.0);
}

TEST(Track, SmoothStartsAndEndsAtRest) {
  const Track<double> track = ramp(Ease::Smooth);
  constexpr double kStep = 1e-4;
  EXPECT_NEAR((track.at(10 + kStep) - track.at(10)) / kStep, 0, 1e-5);
  EXPECT_NEAR((track.at(20) - track.at(20 - kStep)) / kStep, 0, 1e-5);
}

TEST(Transform, TurnsAboutItsPivotXThenYThenZ) {
  Transform t;
  t.pivot = Vec3(1, 0, 0);
  t.rotate = Vec3(0, 0, std::numbers::pi / 2);
  EXPECT_NEAR((t.apply(Vec3(2, 0, 0)) - Vec3(1, 1, 0)).norm(), 0, 1e-15);
  EXPECT_EQ(t.apply(t.pivot), t.pivot);
  t = {};
  t.rotate = Vec3(std::numbers::pi / 2, std::numbers::pi / 2, 0);
  EXPECT_NEAR((t.apply(Vec3(0, 1, 0)) - Vec3(1, 0, 0)).norm(), 0, 1e-15);  // y to z by x, then z to x by y
  t = {};
  t.scale = Vec3(2, 1, 1);
  t.pivot = Vec3(1, 1, 1);
  EXPECT_EQ(t.apply(Vec3(2, 5, 1)), Vec3(3, 5, 1));
}

TEST(Transform, LeavesPointsBitForBitWhereNothingMoves) {
  Transform t;
  t.pivot = Vec3(0.1, 0.2, 0.3);
  const Vec3 p(0.1234567890123, -9.87e-9, 1e9);
  EXPECT_EQ(t.apply(p), p);
}

TEST(IsActive, HoldsInAnyRangeEndsIncluded) {
  EXPECT_TRUE(is_active({}, 7));
  EXPECT_TRUE(is_active({{1, 5}, {8, 9}}, 5));
  EXPECT_FALSE(is_active({{1, 5}, {8, 9}}, 5.5));
  EXPECT_TRUE(is_active({{1, 5}, {8, 9}}, 8));
}

TEST(ActiveRange, HasNoHoleBetweenAFrameThatEndsOneAndTheNextThatBeginsOne) {
  const std::vector<FrameRange> touching{{1, 10}, {11, 20}}, apart{{1, 10}, {12, 20}}, unsorted{{11, 20}, {1, 10}};
  for (const double frame : {1.0, 10.0, 10.25, 10.999}) EXPECT_EQ(active_range(touching, frame), 0) << frame;
  for (const double frame : {11.0, 11.5, 20.0}) EXPECT_EQ(active_range(touching, frame), 1) << frame;
  for (const double frame : {0.999, 20.25}) EXPECT_EQ(active_range(touching, frame), -1) << frame;
  for (const double frame : {10.25, 11.0, 11.9}) EXPECT_EQ(active_range(apart, frame), -1) << frame;
  EXPECT_EQ(active_range(unsorted, 10.5), 1);
  EXPECT_EQ(active_range({{1, 10.25}, {11.25, 20}}, 10.5), -1) << "meant as it is";
}

}  // namespace
}  // namespace softreel
