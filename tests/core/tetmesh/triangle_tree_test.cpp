#include "core/tetmesh/triangle_tree.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/random.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

using test_support::Random;
using test_support::random_vector;

/// The plain twin: every triangle, one by one.
TriangleTree::Nearest nearest_of_all(const SurfaceMesh& surface, const Vec3& p) {
  TriangleTree::Nearest best;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    const Vec3 point =
        nearest_on_triangle(p, surface.positions[at(a)], surface.positions[at(b)], surface.positions[at(c)]);
    const double squared = (point - p).squaredNorm();
    if (squared < best.squared_distance) best = {static_cast<Index>(t), squared, point};
  }
  return best;
}

void expect_equal(const TriangleTree::Nearest& found, const TriangleTree::Nearest& wanted) {
  EXPECT_EQ(found.triangle, wanted.triangle);
  EXPECT_EQ(found.squared_distance, wanted.squared_distance);
  EXPECT_EQ(found.point, wanted.point);
}

/// Triangles of all sizes and shapes, those without area among them.
SurfaceMesh random_soup(Random& random, Index count, double size, const Vec3& center) {
  SurfaceMesh soup;
  for (Index t = 0; t < count; ++t) {
    const Vec3 a = center + size * random_vector(random);
    const double edge = size * std::pow(10.0, -(t % 4));
    const Vec3 b = t % 7 == 0 ? a : Vec3(a + edge * random_vector(random));
    soup.positions.insert(soup.positions.end(), {a, b, Vec3(a + edge * random_vector(random))});
    soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return soup;
}

TEST(TriangleTree, FindsTheNearestOfAllWithAllBits) {
  Random random(2);
  // Counts round the eights that fill nodes and levels.
  for (const Index count : {1, 7, 8, 9, 63, 64, 65, 511, 513, 700, 4095, 4097, 5000}) {
    SCOPED_TRACE(count);
    const SurfaceMesh soup = random_soup(random, count, 1, Vec3::Zero());
    const TriangleTree tree(soup.positions, soup.triangles);
    for (int i = 0; i < 60; ++i) {
      const Vec3 p = std::pow(10.0, i % 5 - 3) * random_vector(random);
      expect_equal(tree.nearest(p), nearest_of_all(soup, p));
    }
  }
}

TEST(TriangleTree, FindsItAtAnySizeAndPlace) {
  Random random(3);
  for (const double size : {1e-9, 1e-6, 1e6})
    for (const double far : {0.0, 1e5, 1e9}) {
      SCOPED_TRACE(::testing::Message() << size << " m, " << far << " m away");
      const Vec3 center = far * Vec3(1, -0.5, 0.25);
      const SurfaceMesh soup = random_soup(random, 300, size, center);
      const TriangleTree tree(soup.positions, soup.triangles);
      for (int i = 0; i < 40; ++i) {
        const Vec3 p = center + 2 * size * random_vector(random);
        expect_equal(tree.nearest(p), nearest_of_all(soup, p));
      }
      expect_equal(tree.nearest(Vec3(1e12, 0, 3)), nearest_of_all(soup, Vec3(1e12, 0, 3)));
      EXPECT_GE(tree.nearest(Vec3(1e60, -1e60, 3)).triangle, 0);
    }
}

TEST(TriangleTree, OfEquallyNearTheLowestNumberCounts) {
  SurfaceMesh soup;
  soup.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  soup.triangles.assign(100, {0, 1, 2});
  const TriangleTree tree(soup.positions, soup.triangles);
  EXPECT_EQ(tree.nearest(Vec3(0.2, 0.2, 1)).triangle, 0);
  const auto odd = [](Index triangle, const Vec3&) { return triangle % 2 == 1; };
  EXPECT_EQ(tree.nearest(Vec3(0.2, 0.2, 1), 1e300, odd).triangle, 1);
}

TEST(TriangleTree, LimitsAndGuessesHold) {
  Random random(4);
  const SurfaceMesh ring = test::make_torus(1, 0.4, 32, 16, Vec3::Zero());
  const TriangleTree tree(ring.positions, ring.triangles);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = random_vector(random);
    const TriangleTree::Nearest wanted = nearest_of_all(ring, p);
    const double squared = wanted.squared_distance;
    const auto any = [](Index, const Vec3&) { return true; };
    EXPECT_EQ(tree.nearest(p, 0.99 * squared, any).triangle, -1);
    expect_equal(tree.nearest(p, 1.01 * squared, any), wanted);
    const auto guess = static_cast<Index>(random() % ring.triangles.size());
    expect_equal(tree.nearest_from(p, guess), wanted);
    expect_equal(tree.nearest_from(p, guess, -1, 1.01 * squared), wanted);
    EXPECT_EQ(tree.nearest_from(p, guess, -1, 0.99 * squared).triangle, -1);
    // What is near enough is never further than it was said, and is where it says.
    const TriangleTree::Nearest enough = tree.nearest_from(p, guess, 4 * squared);
    EXPECT_LE(enough.squared_distance, 4 * squared);
    EXPECT_EQ((enough.point - p).squaredNorm(), enough.squared_distance);
    EXPECT_EQ(tree.order()[at(enough.place)], enough.triangle);
  }
}

TEST(TriangleTree, VisitsWhatMeetsABox) {
  Random random(5);
  const SurfaceMesh soup = random_soup(random, 400, 1, Vec3::Zero());
  const TriangleTree tree(soup.positions, soup.triangles);
  const Vec3 low(-0.5, -0.2, 0.1), high(0.4, 0.6, 0.8);
  const auto meets = [&](const Vec3& min, const Vec3& max) {
    return (min.array() <= high.array()).all() && (low.array() <= max.array()).all();
  };
  std::vector<Index> visits(soup.triangles.size(), 0);
  tree.visit(meets, [&](Index place) { ++visits[at(tree.order()[at(place)])]; });
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto& [a, b, c] = soup.triangles[t];
    const Vec3 &x = soup.positions[at(a)], &y = soup.positions[at(b)], &z = soup.positions[at(c)];
    EXPECT_EQ(visits[t], meets(x.cwiseMin(y).cwiseMin(z), x.cwiseMax(y).cwiseMax(z)) ? 1 : 0) << t;
  }
}

TEST(TriangleTree, APointThatIsNotFiniteFindsNone) {
  Random random(6);
  const SurfaceMesh soup = random_soup(random, 700, 1, Vec3::Zero());
  const TriangleTree tree(soup.positions, soup.triangles);
  EXPECT_EQ(tree.nearest(Vec3(std::nan(""), 0, 0)).triangle, -1);
  EXPECT_EQ(tree.nearest(Vec3::Constant(std::nan(""))).triangle, -1);
}

TEST(TriangleTree, MayBeEmpty) {
  const TriangleTree tree({}, {});
  EXPECT_TRUE(tree.empty());
  EXPECT_EQ(tree.nearest(Vec3::Zero()).triangle, -1);
  tree.visit([](const Vec3&, const Vec3&) { return true; }, [](Index) { ADD_FAILURE(); });
}

TEST(NearestOnTriangle, HoldsForTrianglesWithoutArea) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(2, 0, 0), p(1.5, 1, 0);
  EXPECT_NEAR((nearest_on_triangle(p, a, b, c) - Vec3(1.5, 0, 0)).norm(), 0, 1e-12);
  EXPECT_EQ(nearest_on_triangle(p, a, a, a), a);
}

}  // namespace
}  // namespace softreel
