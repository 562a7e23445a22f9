#include "core/tetmesh/stuffing/thin_parts.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/skinning/embedding.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/support/surfaces.h"
#include "tests/support/tet_checks.h"

namespace softreel {
namespace {

/// Two balls of radius 0.5 round (-1, 0, 0) and (1, 0, 0), joined by a round rod of radius `neck`.
SurfaceMesh make_dumbbell(double neck) {
  return test::make_cube_sides(40, [neck](const Vec3& cube) {
    const Vec3 p = cube.normalized();
    const double s = 1.5 * p.x(), from_ball = (std::abs(s) - 1) / 0.5;
    const double ball = from_ball > -1 ? 0.5 * std::sqrt(std::max(0.0, 1 - from_ball * from_ball)) : 0.0;
    const double rod = std::abs(s) < 1 ? neck : 0.0;
    const double across = std::hypot(p.y(), p.z());
    const double radius = across > 0 ? std::max(ball, rod) / across : 0.0;
    return Vec3(s, radius * p.y(), radius * p.z());
  });
}

TetMesh fill(const SurfaceMesh& surface, double edge, std::vector<std::string>& lines) {
  const auto collect = [&lines](const std::string& line) { lines.push_back(line); };
  StageTimes times;
  return tetrahedralize(surface, {edge, 0}, "dumbbell", Threads(1), {collect, collect}, times);
}

TEST(BridgeThinParts, ARodOfAnyThinnessHoldsTheBallsTogether) {
  constexpr double kEdge = 0.2;
  for (const double neck : {0.1, 0.05, 0.02, 0.004}) {
    std::vector<std::string> lines;
    const TetMesh mesh = fill(make_dumbbell(neck), kEdge, lines);
    test::expect_good_tets(mesh);
    test::expect_manifold_boundary(mesh);
    EXPECT_EQ(test::count_pieces(mesh), 1) << "neck " << neck;
    EXPECT_EQ(test::euler_characteristic(mesh), 2) << "neck " << neck << ": the rod got a hole";
    const bool said = std::any_of(lines.begin(), lines.end(),
                                  [](const std::string& line) { return line.find("thick") != std::string::npos; });
    EXPECT_EQ(said, neck != 0.1) << "the thickening must be said; the thickest rod needs none";
    double near_rod = 0;  // how far the thickened rod reaches from its axis
    for (const Vec3& p : mesh.nodes)
      if (std::abs(p.x()) < 0.25) near_rod = std::max(near_rod, std::hypot(p.y(), p.z()));
    EXPECT_LE(near_rod, neck + 1.3 * kEdge) << "neck " << neck;
  }
}

TEST(BridgeThinParts, WhatTheLatticeCarriesIsLeftAlone) {
  std::vector<std::string> lines;
  fill(make_dumbbell(0.3), 0.12, lines);
  fill(test::make_sphere(1, 16, Vec3(0.03, 0.01, 0.02)), 0.11, lines);
  fill(test::make_torus(1, 0.3, 64, 32, Vec3::Zero()), 0.13, lines);
  for (const std::string& line : lines) ADD_FAILURE() << line;
}

double volume_of(const SurfaceMesh& surface) {
  double sum = 0;
  for (const Triangle& t : surface.triangles) {
    const auto x = [&](std::size_t k) -> const Vec3& { return surface.positions[static_cast<std::size_t>(t[k])]; };
    sum += x(0).cross(x(1)).dot(x(2)) / 6;
  }
  return sum;
}

TEST(WarnOfVolume, ALossIsSaidAsAGainIs) {
  const SurfaceMesh sphere = test::make_sphere(1, 16, Vec3(0.03, 0.01, 0.02));
  int losses = 0;
  for (const double edge : {0.2, 0.4, 0.8, 1.2, 1.6}) {
    std::vector<std::string> lines;
    const double share = measure_quality(fill(sphere, edge, lines), Threads(1)).volume / volume_of(sphere);
    ASSERT_LT(share, 1.05) << edge;
    const bool said = std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
      return line.find("% less volume than") != std::string::npos;
    });
    EXPECT_EQ(said, share < 0.95) << edge << " " << share;
    losses += share < 0.95 ? 1 : 0;
  }
  EXPECT_GT(losses, 0);
  EXPECT_LT(losses, 5);
}

TEST(WarnOfVolume, WhatOverlapsItselfHasLostNothing) {
  // Along the line that the tube follows twice over, its volume counts twice.
  const SurfaceMesh tube = test::make_ring(240, 24, [](double a, double b) -> Vec3 {
    const double ring = 1 + 0.1 * std::cos(b);
    return {ring * std::cos(2 * a), 0.1 * std::sin(b), ring * std::sin(2 * a)};
  });
  std::vector<std::string> lines;
  const double share = measure_quality(fill(tube, 0.06, lines), Threads(1)).volume / std::abs(volume_of(tube));
  EXPECT_LT(share, 0.7);
  for (const std::string& line : lines) EXPECT_EQ(line.find("% less volume"), std::string::npos) << line;
}

TEST(BridgeThinParts, PartsStayApartAcrossAGap) {
  // The thin rod passes over a third ball without touching it.
  SurfaceMesh surface = make_dumbbell(0.02);
  const SurfaceMesh ball = test::make_sphere(0.3, 16, Vec3(0, -0.75, 0));
  const auto first = static_cast<Index>(surface.positions.size());
  surface.positions.insert(surface.positions.end(), ball.positions.begin(), ball.positions.end());
  for (const Triangle& t : ball.triangles) surface.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  std::vector<std::string> lines;
  const TetMesh mesh = fill(surface, 0.15, lines);
  EXPECT_EQ(test::count_pieces(mesh), 2);
}

TEST(BridgeThinParts, ALimbThatGrowsOutOfAnotherPartHangsOnIt) {
  SurfaceMesh surface = test::make_sphere(1, 12, Vec3::Zero());
  test::append(surface, test::make_box({1.25, 0.01, 0.01}, 1, Vec3(1.75, 0, 0)));
  for (const double edge : {0.2, 0.25, 0.3}) {
    std::vector<std::string> lines;
    const TetMesh mesh = fill(surface, edge, lines);
    test::expect_good_tets(mesh);
    EXPECT_EQ(test::count_pieces(mesh), 1) << "edge " << edge;
  }
}

TEST(BridgeThinParts, SaysThatTouchingSolidsBecameOne) {
  SurfaceMesh surface = test::make_box(Vec3::Constant(0.5), 3, Vec3::Constant(0.5));
  test::append(surface, test::make_box(Vec3::Constant(0.5), 3, Vec3(1.5, 1.5, 0.5)));  // at an edge
  std::vector<std::string> lines;
  EXPECT_EQ(test::count_pieces(fill(surface, 0.19, lines)), 1);
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
    return line.find("2 solids that touch") != std::string::npos;
  }));
}

TEST(BridgeThinParts, SaysHowMuchVolumeItAddedAtSharpEdges) {
  SurfaceMesh corner;  // of a unit cube
  corner.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  corner.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::vector<std::string> lines;
  fill(corner, 0.12, lines);
  ASSERT_FALSE(lines.empty());
  EXPECT_NE(lines.back().find("% more volume"), std::string::npos) << lines.back();
}

/// A thin slab and a leg through it: what both enclose is known to be no more than their sum.
TEST(BridgeThinParts, SaysHowMuchVolumeItAddedToSeveralParts) {
  SurfaceMesh surface = test::make_box(Vec3(0.5, 0.04, 0.5), 6, Vec3(0.5, 0.5, 0.5));
  test::append(surface, test::make_box(Vec3(0.1, 0.3, 0.1), 6, Vec3(0.5, 0.3, 0.5)));
  std::vector<std::string> lines;
  fill(surface, 0.15, lines);
  ASSERT_FALSE(lines.empty());
  EXPECT_NE(lines.back().find("% or more too much volume"), std::string::npos) << lines.back();
}

}  // namespace
}  // namespace softreel
