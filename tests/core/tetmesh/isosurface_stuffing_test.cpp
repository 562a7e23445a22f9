#include "core/tetmesh/stuffing/isosurface_stuffing.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/tetmesh/stuffing/boundary_mending.h"
#include "tests/support/tet_checks.h"

namespace softreel {
namespace {

using test::count_pieces;
using test::euler_characteristic;
using test::expect_good_tets;
using test::expect_manifold_boundary;

Bounds lattice_box(double half_size) {
  Bounds box;
  box.add(Vec3::Constant(-half_size));
  box.add(Vec3::Constant(half_size));
  return box;
}

double sphere(const Vec3& p) {
  return p.norm() - 1.0;
}

double torus(const Vec3& p) {
  return std::hypot(std::hypot(p[0], p[1]) - 0.7, p[2]) - 0.25;
}

TetMesh fill(const LatticeFrame& frame, const std::function<double(const Vec3&)>& distance) {
  StuffedMesh stuffed = stuff_isosurface(sample_distance(frame, lattice_box(1.2), distance), Threads(1));
  mend_boundary(stuffed);
  return std::move(stuffed.mesh);
}

TEST(StuffIsosurface, KeepsItsAnglesForSphereAndTorusAtAnyOffset) {
  for (int i = 0; i < 5; ++i) {
    const LatticeFrame frame{Vec3(0.013, 0.027, -0.019) * i, 0.19 - 0.013 * i};
    const TetMesh ball = fill(frame, sphere), ring = fill(frame, torus);
    expect_good_tets(ball);
    expect_good_tets(ring);
    expect_manifold_boundary(ball);
    expect_manifold_boundary(ring);
    EXPECT_EQ(euler_characteristic(ball), 2);
    EXPECT_EQ(euler_characteristic(ring), 0);
    EXPECT_EQ(count_pieces(ball), 1);
    EXPECT_EQ(count_pieces(ring), 1);
  }
}

TEST(StuffIsosurface, VolumeConvergesAtSecondOrder) {
  const double exact = 4.0 / 3.0 * std::numbers::pi;
  const auto error = [&](double spacing) {
    double sum = 0;  // mean over offsets: the error of one lattice is noisy
    for (int i = 0; i < 4; ++i)
      sum +=
          std::abs(measure_quality(fill({Vec3(0.011, 0.017, 0.023) * i, spacing}, sphere), Threads(1)).volume - exact);
    return sum / 4;
  };
  const double coarse = error(0.3), fine = error(0.1);
  EXPECT_LT(coarse, 0.08 * exact);
  EXPECT_LT(fine, coarse / 7);  // 9 at second order, 3 at first
}

TEST(StuffIsosurface, BoundaryLiesNearTheSurface) {
  const double spacing = 0.1;
  const TetMesh ball = fill({Vec3(0.01, 0.02, 0.03), spacing}, sphere);
  for (const Triangle& face : boundary_faces(ball))
    for (const Index node : face)
      EXPECT_NEAR(ball.nodes[static_cast<std::size_t>(node)].norm(), 1.0, spacing * spacing / 4);
}

TEST(StuffIsosurface, KeepsItsAnglesForRandomValues) {
  // Distances that no surface has: the bound must not depend on what they mean.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  for (int i = 0; i < 4; ++i) {
    const auto noise = [&](const Vec3& p) { return p.cwiseAbs().maxCoeff() > 0.9 ? 1.0 : std::pow(value(random), 3); };
    StuffedMesh stuffed = stuff_isosurface(sample_distance({Vec3::Zero(), 0.2}, lattice_box(1.0), noise), Threads(1));
    ASSERT_GT(stuffed.mesh.tets.size(), 1000U);
    expect_good_tets(stuffed.mesh);
    mend_boundary(stuffed);
    expect_good_tets(stuffed.mesh);
    expect_manifold_boundary(stuffed.mesh);
  }
}

TEST(StuffIsosurface, KeepsItsAnglesInTheAdversarialCase) {
  // Nodes at (+-1, 1, 1) warped by the largest step along their short edges towards N = (0, 0, 2), the long edge from
  // the origin to N cut just beyond the warping distance.
  LatticeDistance distance = sample_distance({Vec3::Zero(), 2.0}, lattice_box(8.0), [](const Vec3&) { return 1.0; });
  const auto set = [&](const LatticeNode& node, double value) {
    distance.values[static_cast<std::size_t>(distance.nodes.find(node))] = value;
  };
  for (const double inside : {-1.0, 1.0}) {
    for (double& value : distance.values) value = 0.8 * inside;  // no other edge is cut near an end
    set({0, 0, 2}, -inside * 1.0);
    set({0, 0, 0}, inside / 3.0 * 1.0001);
    const double near = kWarpShort / (1.0 - kWarpShort) * 0.9999;
    set({1, 1, 1}, inside * near);
    set({-1, 1, 1}, inside * near);
    // An inside that reaches the border of the set would have no neighbours there.
    for (std::size_t i = 0; i < distance.values.size(); ++i) {
      const LatticeNode& node = distance.nodes.nodes()[i];
      if (std::max({std::abs(node[0]), std::abs(node[1]), std::abs(node[2])}) > 5) distance.values[i] = 0.8;
    }
    const TetMesh mesh = stuff_isosurface(distance, Threads(1)).mesh;
    expect_good_tets(mesh);
    const double worst = inside < 0 ? 10.3 : 90;  // with N outside it is the worst case known
    EXPECT_LT(measure_quality(mesh, Threads(1)).min_dihedral, worst);
  }
}

TEST(StuffIsosurface, GivesEqualBitsAtOneAndFourThreads) {
  const LatticeDistance distance = sample_distance({Vec3(0.01, 0.02, 0.03), 0.08}, lattice_box(1.2), torus);
  const StuffedMesh one = stuff_isosurface(distance, Threads(1)), four = stuff_isosurface(distance, Threads(4));
  EXPECT_EQ(one.mesh.nodes, four.mesh.nodes);
  EXPECT_EQ(one.mesh.tets, four.mesh.tets);
}

TEST(StuffIsosurface, OfNothingInsideIsEmpty) {
  EXPECT_TRUE(fill({Vec3::Zero(), 0.3}, [](const Vec3&) { return 1.0; }).tets.empty());
}

TEST(MendBoundary, PartsBallsThatTouch) {
  // Two lattice nodes two long edges apart, each alone inside: their cells meet at a node.
  LatticeDistance distance = sample_distance({Vec3::Zero(), 2.0}, lattice_box(8.0), [](const Vec3&) { return 1.0; });
  const auto set = [&](const LatticeNode& node, double value) {
    distance.values[static_cast<std::size_t>(distance.nodes.find(node))] = value;
  };
  set({-2, 0, 0}, -1.0);
  set({2, 0, 0}, -1.0);
  set({0, 0, 0}, 0.0);
  StuffedMesh stuffed = stuff_isosurface(distance, Threads(1));
  EXPECT_EQ(count_pieces(stuffed.mesh), 2);
  const BoundaryMending mending = mend_boundary(stuffed);
  EXPECT_EQ(mending.copied_nodes, 1);
  EXPECT_EQ(mending.removed_tets, 0);
  expect_manifold_boundary(stuffed.mesh);
  EXPECT_EQ(euler_characteristic(stuffed.mesh), 4);
}

}  // namespace
}  // namespace softreel
