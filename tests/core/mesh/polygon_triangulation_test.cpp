#include "core/mesh/polygon_triangulation.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace softreel {
namespace {

Vec3 area(const std::vector<Vec3>& p, const Triangle& t) {
  const auto at = [&](std::size_t k) { return p[static_cast<std::size_t>(t[k])]; };
  return 0.5 * (at(1) - at(0)).cross(at(2) - at(0));
}

/// A simple planar polygon is covered exactly: the areas add up without a negative one.
void expect_exact_cover(const std::vector<Vec3>& polygon, const Vec3& normal) {
  const std::vector<Triangle> triangles = triangulate_polygon(polygon);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  double whole = 0, parts = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    whole += area(polygon, {0, static_cast<Index>(i), static_cast<Index>(i + 1)}).dot(normal);
  for (const Triangle& t : triangles) {
    EXPECT_GE(area(polygon, t).dot(normal), -1e-12 * whole);
    parts += area(polygon, t).norm();
  }
  EXPECT_NEAR(parts, whole, 1e-12 * whole);
}

TEST(TriangulatePolygon, CutsAQuadAlongItsShorterDiagonal) {
  const std::vector<Vec3> kite{{0, 0, 0}, {2, -1, 0}, {4, 0, 0}, {2, 1, 0}};
  EXPECT_EQ(triangulate_polygon(kite), std::vector<Triangle>({{0, 1, 3}, {1, 2, 3}}));
}

TEST(TriangulatePolygon, CutsAConcaveQuadInsideThoughItsOtherDiagonalIsShorter) {
  for (std::size_t start = 0; start < 4; ++start) {
    const std::vector<Vec3> dart{{0, 0, 0}, {1, 4, 0}, {0, 1, 0}, {-1, 4, 0}};
    std::vector<Vec3> turned;
    for (std::size_t k = 0; k < 4; ++k) turned.push_back(dart[(start + k) % 4]);
    expect_exact_cover(turned, Vec3::UnitZ());
  }
}

TEST(TriangulatePolygon, CoversConcavePolygonsInAnyPlane) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> radius(0.2, 1.0), coordinate(-1, 1);
  for (int n = 5; n < 60; ++n) {
    const Vec3 normal = Vec3(coordinate(random), coordinate(random), coordinate(random)).normalized();
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    std::vector<Vec3> star;  // star-shaped: simple, mostly concave
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n, r = radius(random);
      star.emplace_back(Vec3(5, 6, 7) + r * std::cos(angle) * u + r * std::sin(angle) * v);
    }
    expect_exact_cover(star, normal);
  }
}

TEST(TriangulatePolygon, CoversACombAndAKeyhole) {
  std::vector<Vec3> comb;
  for (int tooth = 0; tooth < 8; ++tooth) {
    comb.emplace_back(2 * tooth, 5, 0);
    comb.emplace_back(2 * tooth + 1, 1, 0);
  }
  comb.emplace_back(16, 0, 0);
  comb.emplace_back(0, 0, 0);
  std::reverse(comb.begin(), comb.end());
  expect_exact_cover(comb, Vec3::UnitZ());
  // A square with a square hole, joined by a bridge that the outline passes twice.
  expect_exact_cover(
      {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}, {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}},
      Vec3::UnitZ());
}

/// A band of `corners` corners that winds `turns` times round the origin.
std::vector<Vec3> spiral(int corners, int turns) {
  std::vector<Vec3> outside, inside;
  for (int i = 0; i < corners / 2; ++i) {
    const double angle = 2 * std::numbers::pi * turns * i / (corners / 2), r = 1 + angle;
    const Vec3 direction(std::cos(angle), std::sin(angle), 0);
    inside.push_back(r * direction);
    outside.push_back((r + 2) * direction);
  }
  outside.insert(outside.end(), inside.rbegin(), inside.rend());
  return outside;
}

TEST(TriangulatePolygon, IsSoonDoneWithThousandsOfCorners) {
  const std::clock_t begin = std::clock();  // of the processor: other processes do not count
  expect_exact_cover(spiral(12000, 40), Vec3::UnitZ());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> radius(1, 1.3);
  std::vector<Vec3> spikes;  // of two radii a corner, so that they cross
  for (int i = 0; i < 12000; ++i) {
    const double angle = 2 * std::numbers::pi * i / 12000;
    spikes.emplace_back(radius(random) * std::cos(angle), radius(random) * std::sin(angle), 0);
  }
  EXPECT_EQ(triangulate_polygon(spikes).size(), spikes.size() - 2);
  // Hundredths of a second; minutes where each corner is compared with each again and again.
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 5.0);
}

TEST(TriangulatePolygon, CutsWhatHasNoAreaOrCrossesItself) {
  const std::vector<Vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}};
  EXPECT_EQ(triangulate_polygon(line).size(), 4U);
  const std::vector<Vec3> point(7, Vec3::Zero());
  EXPECT_EQ(triangulate_polygon(point).size(), 5U);
  const std::vector<Vec3> pentagram{{0, 1, 0}, {0.6, -0.8, 0}, {-1, 0.3, 0}, {1, 0.3, 0}, {-0.6, -0.8, 0}};
  EXPECT_EQ(triangulate_polygon(pentagram).size(), 3U);
}

}  // namespace
}  // namespace softreel
