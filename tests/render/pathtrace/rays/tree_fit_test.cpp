#include "render/pathtrace/rays/tree_fit.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

MotionMesh ball() {
  return sphere(Vec3f(0, 1, 0), 0.5f, matte(0.5f), 24);
}

template <typename Move>
double looseness_after(const Move& move) {
  const MotionMesh mesh = ball();
  const std::vector<Vec3f>& rest = mesh.times[0].positions;
  std::vector<Vec3f> moved;
  for (const Vec3f& p : rest) moved.push_back(move(p));
  return TreeFit(rest, mesh.triangles).looseness(moved);
}

TEST(TreeFit, IsExactlyOneAtRest) {
  EXPECT_EQ(looseness_after([](const Vec3f& p) { return p; }), 1);
}

TEST(TreeFit, IsOneAfterQuarterTurnScalingAndShift) {
  EXPECT_NEAR(looseness_after([](const Vec3f& p) -> Vec3f { return 3 * Vec3f(-p.z(), p.y(), p.x()) + Vec3f(1, 2, 3); }),
              1, 1e-4);
}

TEST(TreeFit, StaysNearOneWhereAllIsStretchedAlike) {
  EXPECT_NEAR(looseness_after([](const Vec3f& p) { return Vec3f(p.x(), 4 * p.y(), p.z()); }), 1, 0.2);
}

TEST(TreeFit, GrowsWhereNeighboursArePulledApart) {
  const MotionMesh mesh = ball();
  std::vector<Vec3f> corners;
  std::vector<Triangle> alone;
  for (const Triangle& t : mesh.triangles) {  // triangles that share no vertex can be dealt out like cards
    const auto first = static_cast<Index>(corners.size());
    for (const Index corner : t) corners.push_back(mesh.times[0].positions[static_cast<std::size_t>(corner)]);
    alone.push_back({first, first + 1, first + 2});
  }
  std::vector<Vec3f> dealt = corners;
  for (std::size_t k = 0; k < dealt.size(); ++k) dealt[k].x() += k / 3 % 2 == 0 ? 0.0f : 5.0f;
  EXPECT_GT(TreeFit(corners, alone).looseness(dealt), 3);
}

TEST(TreeFit, IsInfiniteWhereTrianglesShrinkToPointsThatStandApart) {
  const MotionMesh mesh = ball();
  std::vector<Vec3f> rest;
  for (const Triangle& t : mesh.triangles)
    for (const Index corner : t) rest.push_back(mesh.times[0].positions[static_cast<std::size_t>(corner)]);
  std::vector<Triangle> alone;
  std::vector<Vec3f> points = rest;
  for (std::size_t k = 0; k < rest.size(); k += 3) {
    const auto first = static_cast<Index>(k);
    alone.push_back({first, first + 1, first + 2});
    points[k + 1] = points[k + 2] = points[k];
  }
  EXPECT_TRUE(std::isinf(TreeFit(rest, alone).looseness(points)));
}

TEST(TreeFit, ForgetsWhatItWasAskedBefore) {
  const MotionMesh mesh = ball();
  std::vector<Vec3f> bent = mesh.times[0].positions;
  for (Vec3f& p : bent) p.x() += p.y() * p.y();
  const TreeFit asked(mesh.times[0].positions, mesh.triangles), fresh = asked;
  asked.looseness(mesh.times[0].positions);
  EXPECT_EQ(asked.looseness(bent), fresh.looseness(bent));
}

TEST(IsWorthFitting, AlwaysAtRestAndLessTheLooserTheTreeAndTheMoreThePaths) {
  EXPECT_TRUE(is_worth_fitting(1, 1000, 1e12));
  EXPECT_TRUE(is_worth_fitting(1.1, 1000000, 1e5));
  EXPECT_FALSE(is_worth_fitting(1.1, 1000000, 1e8));
  EXPECT_FALSE(is_worth_fitting(1.1, 100, 1e5));
  EXPECT_FALSE(is_worth_fitting(20, 1000000, 1e5));
  EXPECT_FALSE(is_worth_fitting(std::nan(""), 1000000, 1));
}

}  // namespace
}  // namespace softreel
