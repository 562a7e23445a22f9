#include "core/mesh/point_tree.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(PointTree, FindsWhatBruteForceFinds) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> coordinate(0, 9);  // coarse, so that many points are equally near
  for (const std::size_t count : {1U, 2U, 3U, 10U, 300U}) {
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = Vec3(coordinate(random), coordinate(random), coordinate(random));
    const PointTree tree(points);
    for (int query = 0; query < 200; ++query) {
      const Vec3 q(coordinate(random) + 0.5, coordinate(random), coordinate(random));
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < count; ++i)
        if ((points[i] - q).squaredNorm() < (points[nearest] - q).squaredNorm()) nearest = i;
      EXPECT_EQ(tree.nearest(q), static_cast<Index>(nearest));
    }
  }
}

TEST(PointTree, FindsTheNextOnesInOrder) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> coordinate(0, 6);
  std::vector<Vec3> points(300);
  for (Vec3& p : points) p = Vec3(coordinate(random), coordinate(random), coordinate(random));
  const PointTree tree(points);
  for (int query = 0; query < 50; ++query) {
    const Vec3 q(coordinate(random), coordinate(random), coordinate(random));
    std::vector<Index> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
      return (points[at(a)] - q).squaredNorm() < (points[at(b)] - q).squaredNorm();
    });
    for (const std::size_t count : {0U, 1U, 7U, 300U, 400U}) {
      const std::vector<Index> expected(order.begin(),
                                        order.begin() + static_cast<std::ptrdiff_t>(std::min(count, order.size())));
      EXPECT_EQ(tree.nearest(q, count), expected);
    }
  }
}

TEST(PointTree, HasNoNearestOfNoPoints) {
  EXPECT_EQ(PointTree({}).nearest(Vec3::Zero()), -1);
  EXPECT_TRUE(PointTree({}).nearest(Vec3::Zero(), 3).empty());
}

}  // namespace
}  // namespace softreel
