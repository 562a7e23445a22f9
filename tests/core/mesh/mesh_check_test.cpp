#include "core/mesh/mesh_check.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "tests/core/mesh/mesh_files.h"
#include "tests/support/random.h"

namespace softreel {
namespace {

using testing::add_box;
using testing::make_mesh;
using testing::unit_box;

bool says(const MeshFacts& facts, const std::string& words) {
  for (const std::string& line : describe(facts))
    if (line.find(words) != std::string::npos) return true;
  return false;
}

TEST(CheckMesh, FindsNothingWrongWithABox) {
  const MeshFacts facts = check_mesh(unit_box());
  EXPECT_EQ(facts.distinct_vertices, 8);
  EXPECT_EQ(facts.edges, 18);
  EXPECT_EQ(facts.pieces, 1);
  EXPECT_TRUE(facts.closed());
  EXPECT_NEAR(facts.signed_volume, 1, 1e-15);
  EXPECT_EQ(describe(facts).size(), 1U);
}

TEST(CheckMesh, WeldsSeamsExactly) {
  SurfaceMesh soup;  // every corner its own vertex
  const SurfaceMesh box = unit_box();
  std::vector<Triangle> triangles;
  for (const Triangle& t : box.triangles) {
    const auto first = static_cast<Index>(soup.positions.size());
    for (const Index v : t) soup.positions.push_back(box.positions[static_cast<std::size_t>(v)]);
    triangles.push_back({first, first + 1, first + 2});
  }
  const MeshFacts facts = check_mesh(make_mesh(soup.positions, triangles));
  EXPECT_EQ(facts.vertices, 36);
  EXPECT_EQ(facts.distinct_vertices, 8);
  EXPECT_TRUE(facts.closed());
}

/// Squares of a grid of 4 x 4, but for those that `missing` names by 4 y + x.
SurfaceMesh grid_without(const std::vector<Index>& missing) {
  std::vector<Vec3> points;
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 5; ++x) points.emplace_back(x, y, 0);
  std::vector<Triangle> triangles;
  for (Index square = 0; square < 16; ++square) {
    if (std::find(missing.begin(), missing.end(), square) != missing.end()) continue;
    const Index v = 5 * (square / 4) + square % 4;
    triangles.push_back({v, v + 1, v + 6});
    triangles.push_back({v, v + 6, v + 5});
  }
  return make_mesh(points, triangles);
}

TEST(CheckMesh, CountsHoles) {
  SurfaceMesh box = unit_box();
  box.triangles.erase(box.triangles.begin());
  EXPECT_EQ(check_mesh(box).holes, 1);
  EXPECT_EQ(check_mesh(grid_without({})).holes, 1);  // its rim
  EXPECT_EQ(check_mesh(grid_without({5})).holes, 2);
  EXPECT_TRUE(says(check_mesh(grid_without({5})), "2 holes (20 boundary edges)"));
}

TEST(CheckMesh, FollowsHolesRoundFansOfTriangles) {
  // Squares 0 and 5 touch in one vertex: two sheets, two rims. Squares 5 and 10 missing: one hole with a waist.
  EXPECT_EQ(check_mesh(grid_without({1, 2, 3, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15})).holes, 2);
  EXPECT_EQ(check_mesh(grid_without({5, 10})).holes, 2);
}

TEST(CheckMesh, CountsFlipsDuplicatesCollapsedAndFlatTriangles) {
  SurfaceMesh mesh = unit_box();
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  EXPECT_EQ(check_mesh(mesh).flipped_neighbours, 3);
  mesh.triangles.push_back({mesh.triangles[5][1], mesh.triangles[5][2], mesh.triangles[5][0]});
  mesh.triangles.push_back({0, 0, 1});
  mesh.positions.emplace_back(2, 0, 0);
  mesh.triangles.push_back({0, 1, 8});
  mesh.positions.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  const MeshFacts facts = check_mesh(mesh);
  EXPECT_EQ(facts.duplicate_triangles, 1);
  EXPECT_EQ(facts.collapsed_triangles, 1);
  EXPECT_EQ(facts.flat_triangles, 1);
  EXPECT_EQ(facts.not_finite, 1);
  EXPECT_GT(facts.non_manifold_edges, 0);
  for (const char* words : {"1 duplicate face", "two corners in one place", "without area", "not finite",
                            "1 vertex used by no face", "point to opposite sides", "of more than two faces"})
    EXPECT_TRUE(says(facts, words)) << words;
}

TEST(CheckMesh, SaysThatAllFacesPointInwardFarFromTheOrigin) {
  SurfaceMesh mesh;
  add_box(mesh, Vec3(1e6, 1e6, 1e6), Vec3(1e6 + 1, 1e6 + 1, 1e6 + 1), true);
  add_box(mesh, Vec3(1e6 + 2, 1e6, 1e6), Vec3(1e6 + 3, 1e6 + 1, 1e6 + 1), true);
  const MeshFacts facts = check_mesh(mesh);
  EXPECT_NEAR(facts.signed_volume, -2, 1e-9);
  EXPECT_EQ(facts.pieces, 2);
  EXPECT_TRUE(says(facts, "all faces point inward"));
}

TEST(WeldPositions, FindsTheFirstOfEqualPoints) {
  test_support::Random random(11);
  // Few places for many points; whole numbers leave most bits of a key at 0.
  for (const double step : {1.0, 1.0 / 3, 1e-9}) {
    std::vector<Vec3> points;
    for (int i = 0; i < 600; ++i) points.push_back(step * (6 * test_support::random_vector(random)).array().round());
    const std::vector<Index> weld = weld_positions(points);
    for (std::size_t v = 0; v < points.size(); ++v)
      ASSERT_EQ(weld[v], std::find(points.begin(), points.end(), points[v]) - points.begin());
  }
}

TEST(WeldPositions, KeepsPointsThatAreNotNumbersApart) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3> points{{nan, 0, 0}, {1, 2, 3},    {0, nan, 0}, {1, 2, 3},
                                 {nan, 0, 0}, {0, 0, -0.0}, {0, 0, 0.0}};
  EXPECT_EQ(weld_positions(points), std::vector<Index>({0, 1, 2, 1, 4, 5, 5}));
}

}  // namespace
}  // namespace softreel
