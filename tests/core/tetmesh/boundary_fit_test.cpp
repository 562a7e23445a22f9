#include "core/tetmesh/boundary/boundary_fit.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/tetmesh/quality/tet_quality.h"
#include "core/tetmesh/stuffing/boundary_mending.h"
#include "tests/support/surfaces.h"
#include "tests/support/tet_checks.h"

namespace softreel {
namespace {

/// Stuffs the inside of a signed distance in the cube of half size 1.4.
StuffedMesh stuff(double spacing, const std::function<double(const Vec3&)>& distance) {
  Bounds box;
  box.add(Vec3::Constant(-1.4));
  box.add(Vec3::Constant(1.4));
  StuffedMesh stuffed =
      stuff_isosurface(sample_distance({Vec3(0.013, 0.027, -0.019), spacing}, box, distance), Threads(1));
  mend_boundary(stuffed);
  return stuffed;
}

double ball(const Vec3& p) {
  return p.norm() - 1;
}

/// A cube of half size 0.9 whose edges are rounded with the given radius.
double rounded_cube(const Vec3& p, double radius) {
  const Vec3 q = p.cwiseAbs().array() - (0.9 - radius);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - radius;
}

SurfaceMesh rounded_cube_surface(double radius, Index cells) {
  const double inner = 0.9 - radius;
  return test::make_cube_sides(cells, [&](const Vec3& p) {
    const Vec3 core = (0.9 * p).cwiseMax(-inner).cwiseMin(inner);
    const Vec3 beyond = 0.9 * p - core;
    return Vec3(core + (beyond.norm() > 0 ? radius * beyond.normalized() : beyond));
  });
}

TEST(FitBoundary, PutsTheNodesOfABallOnTheSphere) {
  StuffedMesh stuffed = stuff(0.17, ball);
  fit_boundary(stuffed, test::make_sphere(1, 96, Vec3::Zero()), {}, Threads(1));
  for (const Triangle& face : boundary_faces(stuffed.mesh))
    for (const Index node : face) EXPECT_NEAR(stuffed.mesh.nodes[static_cast<std::size_t>(node)].norm(), 1.0, 3e-4);
  test::expect_good_tets(stuffed.mesh);
  test::expect_manifold_boundary(stuffed.mesh);
}

TEST(FitBoundary, BringsSharpEdgesNearerAndKeepsRoundOnes) {
  for (const double radius : {0.0, 0.1, 0.3}) {
    const SurfaceMesh surface = rounded_cube_surface(radius, 60);
    StuffedMesh stuffed = stuff(0.15, [&](const Vec3& p) { return rounded_cube(p, radius); });
    const double before = measure_deviation(surface, stuffed.mesh, Threads(1)).two_way();
    fit_boundary(stuffed, surface, {}, Threads(1));
    const double after = measure_deviation(surface, stuffed.mesh, Threads(1)).two_way();
    EXPECT_LT(after, (radius == 0 ? 0.8 : 1.02) * before) << "radius " << radius;
    test::expect_good_tets(stuffed.mesh);
    test::expect_manifold_boundary(stuffed.mesh);
  }
}

TEST(FitBoundary, DistanceToARoundedCubeConverges) {
  const SurfaceMesh surface = rounded_cube_surface(0.4, 60);
  const auto distance = [&](double spacing) {
    StuffedMesh stuffed = stuff(spacing, [](const Vec3& p) { return rounded_cube(p, 0.4); });
    fit_boundary(stuffed, surface, {}, Threads(1));
    return measure_deviation(surface, stuffed.mesh, Threads(1)).two_way();
  };
  const double coarse = distance(0.24), fine = distance(0.12);
  EXPECT_LT(coarse, 0.03);
  EXPECT_LT(fine, coarse / 2.2);  // 4 at second order
}

TEST(FitBoundary, NeverWorsensAnglesBeyondItsBounds) {
  // Values that no surface has, drawn to a surface that they do not know.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  const SurfaceMesh surface = test::make_torus(0.8, 0.3, 60, 30, Vec3::Zero());
  const BoundaryFitParams params;
  for (int i = 0; i < 3; ++i) {
    StuffedMesh stuffed = stuff(0.2, [&](const Vec3& p) { return p.cwiseAbs().maxCoeff() > 1 ? 1.0 : value(random); });
    const TetQuality before = measure_quality(stuffed.mesh, Threads(1));
    const std::vector<Tet> tets = stuffed.mesh.tets;
    const std::vector<Vec3> nodes = stuffed.mesh.nodes;
    fit_boundary(stuffed, surface, params, Threads(1));
    const TetQuality after = measure_quality(stuffed.mesh, Threads(1));
    EXPECT_EQ(stuffed.mesh.tets, tets);
    EXPECT_NE(stuffed.mesh.nodes, nodes);
    EXPECT_GT(after.min_volume, 0);
    EXPECT_GE(after.min_dihedral, std::min(before.min_dihedral, params.min_dihedral) - 1e-9);
    EXPECT_LE(after.max_dihedral, std::max(before.max_dihedral, params.max_dihedral) + 1e-9);
  }
}

TEST(FitBoundary, GivesEqualBitsAtOneAndFourThreads) {
  const SurfaceMesh surface = rounded_cube_surface(0.05, 40);
  StuffedMesh one = stuff(0.11, [](const Vec3&p) { return rounded_cube(p, 0.05); }), four = one;
  fit_boundary(one, surface, {}, Threads(1));
  fit_boundary(four, surface, {}, Threads(4));
  EXPECT_EQ(one.mesh.nodes, four.mesh.nodes);
}

}  // namespace
}  // namespace softreel
