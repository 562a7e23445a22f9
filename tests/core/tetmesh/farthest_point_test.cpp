#include "core/tetmesh/farthest_point.h"

#include <random>

#include <gtest/gtest.h>

#include "core/tetmesh/quality/tet_quality.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

double from_to(const SurfaceMesh& from, const SurfaceMesh& to, int threads = 1) {
  return farthest_distance(from.positions, from.triangles, TriangleTree(to.positions, to.triangles), Threads(threads));
}

TEST(FarthestDistance, OfConcentricSpheresIsTheGap) {
  const SurfaceMesh inner = test::make_sphere(1, 64, Vec3::Zero()), outer = test::make_sphere(1.25, 64, Vec3::Zero());
  EXPECT_NEAR(from_to(inner, outer), 0.25, 0.004);
  EXPECT_NEAR(from_to(outer, inner), 0.25, 0.004);
}

TEST(FarthestDistance, FromABoxToTheSphereInItIsThatOfTheCorners) {
  const SurfaceMesh box = test::make_box({1, 1, 1}, 1, Vec3::Zero()), sphere = test::make_sphere(1, 64, Vec3::Zero());
  EXPECT_NEAR(from_to(box, sphere), std::sqrt(3.0) - 1, 0.002);
}

TEST(FarthestDistance, FromASphereToItsBoxIsFarthestBetweenTheVerticesOfTheBox) {
  // The sphere's points under the corners of a box of 12 triangles: what samples at its vertices cannot see.
  const SurfaceMesh box = test::make_box({1, 1, 1}, 1, Vec3::Zero()), sphere = test::make_sphere(1, 64, Vec3::Zero());
  EXPECT_NEAR(from_to(sphere, box), 1 - 1 / std::sqrt(3.0), 0.002);
  // The other way round: a box whose vertices all touch the larger sphere is farthest from it in the middle of a side.
  const SurfaceMesh round = test::make_sphere(std::sqrt(3.0), 64, Vec3::Zero());
  EXPECT_NEAR(from_to(box, round), std::sqrt(3.0) - 1, 0.01 * (std::sqrt(3.0) - 1) + 0.001);
}

TEST(FarthestDistance, FindsAHoleInsideOneLargeTriangle) {
  // A grid of small triangles with some missing, and one triangle over all of it.
  const SurfaceMesh flat = test::make_box({1, 1, 0}, 64, Vec3::Zero());
  SurfaceMesh holed = flat, plate;
  std::erase_if(holed.triangles, [&](const Triangle& t) {
    const Vec3 p = holed.positions[static_cast<std::size_t>(t[0])];
    return (p - Vec3(-0.41, -0.33, 0)).norm() < 0.2;
  });
  plate.positions = {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(-1, 1, 0)};
  plate.triangles = {{0, 1, 2}};
  const double found = from_to(plate, holed);
  EXPECT_NEAR(found, 0.2, 0.035);  // the edge of the hole is a row of teeth
  EXPECT_LT(from_to(plate, flat), 1e-12);
}

TEST(FarthestDistance, IsAsFarAsDenseSamplesAndNoFarther) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-1, 1);
  const auto soup = [&](int count) {
    SurfaceMesh mesh;
    for (Index t = 0; t < count; ++t) {
      for (int k = 0; k < 3; ++k) mesh.positions.emplace_back(value(random), value(random), value(random));
      mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
  };
  for (int i = 0; i < 20; ++i) {
    const SurfaceMesh a = soup(3), b = soup(8);
    const TriangleTree tree(b.positions, b.triangles);
    double sampled = 0, step = 0;
    constexpr int kSteps = 60;
    for (const auto& [u, v, w] : a.triangles) {
      const Vec3 &x = a.positions[static_cast<std::size_t>(u)], y = a.positions[static_cast<std::size_t>(v)] - x,
                 z = a.positions[static_cast<std::size_t>(w)] - x;
      step = std::max({step, y.norm() / kSteps, z.norm() / kSteps});
      for (int p = 0; p <= kSteps; ++p)
        for (int q = 0; p + q <= kSteps; ++q)
          sampled = std::max(sampled, tree.nearest(x + y * p / kSteps + z * q / kSteps).squared_distance);
    }
    sampled = std::sqrt(sampled);
    const double found = from_to(a, b);
    EXPECT_GE(found, sampled * (1 - kFarthestTolerance) - 0.15);  // the mean edge of such triangles is about 1
    EXPECT_LE(found, sampled + step);
  }
}

/// Between two balls a needle and a flat triangle are farthest in their middle.
TEST(FarthestDistance, OfThinTrianglesIsThatOfTheirMiddle) {
  SurfaceMesh balls = test::make_sphere(1, 12, Vec3::Zero());
  test::append(balls, test::make_sphere(1, 12, Vec3(1e3, 0, 0)));
  const TriangleTree tree(balls.positions, balls.triangles);
  for (const Vec3& third : {Vec3(0, 1e-3, 0), Vec3(450, 1e-3, 0)}) {
    const std::vector<Vec3> points{Vec3(0, 0, 0), Vec3(1e3, 0, 0), third};
    EXPECT_NEAR(farthest_distance(points, {{0, 1, 2}}, tree, Threads(1)), 499, 0.011 * 499);
  }
}

TEST(FarthestDistance, GivesEqualBitsAtOneAndFourThreads) {
  const SurfaceMesh a = test::make_torus(1, 0.4, 40, 20, Vec3::Zero()), b = test::make_sphere(1, 9, Vec3::Zero());
  EXPECT_EQ(from_to(a, b, 1), from_to(a, b, 4));
  EXPECT_EQ(from_to(SurfaceMesh{}, b), 0);
}

TEST(MeasureDeviation, SeesBothWays) {
  // Half of the surface has no mesh, and the mesh has a bump that the surface lacks.
  TetMesh mesh;
  mesh.nodes = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  mesh.tets = {{0, 1, 2, 3}};
  SurfaceMesh surface;
  surface.positions = mesh.nodes;
  surface.triangles = boundary_faces(mesh);
  EXPECT_LT(measure_deviation(surface, mesh, Threads(1)).two_way(), 1e-12);
  SurfaceMesh more = surface;
  test::append(more, test::make_box({0.1, 0.1, 0.1}, 1, Vec3(-2, 0, 0)));
  const SurfaceDeviation missing = measure_deviation(more, mesh, Threads(1));
  EXPECT_NEAR(missing.from_surface, Vec3(2.1, 0.1, 0.1).norm(), 0.01 * 2.1);
  EXPECT_LT(missing.from_boundary, 1e-12);
  mesh.nodes[3][2] = 1.5;
  const SurfaceDeviation extra = measure_deviation(surface, mesh, Threads(1));
  EXPECT_NEAR(extra.from_boundary, 0.5, 0.005);
  EXPECT_EQ(extra.two_way(), extra.from_boundary);
}

}  // namespace
}  // namespace softreel
