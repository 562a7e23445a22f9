// Angles, flips and smoothing on a handful of elements where the right answer is known.
#include "core/tetmesh/improvement/flips.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/tetmesh/improvement/node_smoothing.h"
#include "tests/support/tet_checks.h"

namespace softreel {
namespace {

Vec3 on_circle(int i, int n) {
  const double angle = 2 * std::numbers::pi * i / n;
  return {std::cos(angle), std::sin(angle), 0};
}

/// Two apexes at z = -height and height (nodes 0, 1) over a regular ring of radius 1 (nodes 2 ...).
TetMesh apexes_over_ring(int n, double height) {
  TetMesh mesh;
  mesh.nodes = {Vec3(0, 0, -height), Vec3(0, 0, height)};
  for (int i = 0; i < n; ++i) mesh.nodes.push_back(on_circle(i, n));
  return mesh;
}

/// n elements round the edge between the apexes.
TetMesh round_edge(int n, double height) {
  TetMesh mesh = apexes_over_ring(n, height);
  for (Index i = 0; i < n; ++i) mesh.tets.push_back({0, 1, 2 + i, 2 + (i + 1) % n});
  return mesh;
}

/// Two elements at one triangle.
TetMesh at_triangle(double height) {
  TetMesh mesh = apexes_over_ring(3, height);
  mesh.tets = {{2, 3, 4, 1}, {2, 4, 3, 0}};
  return mesh;
}

bool has_edge(const TetMesh& mesh, Index a, Index b) {
  return std::ranges::any_of(
      mesh.tets, [&](const Tet& tet) { return std::ranges::count(tet, a) + std::ranges::count(tet, b) == 2; });
}

/// A mesh that is being changed, with targets that nothing reaches.
struct Work {
  explicit Work(const TetMesh& given) : mesh(given), measure(any_angle()), tets(mesh, measure), flips(tets) {}
  static AngleMeasure any_angle() {
    AngleMeasure measure(60, 95);
    measure.admit({1, -1});
    return measure;
  }
  TetMesh mesh;
  AngleMeasure measure;
  TetStars tets;
  Flips flips;
};

/// The same room, filled with positive elements.
void expect_same_room(const TetMesh& after, const TetMesh& before) {
  const TetQuality was = measure_quality(before, Threads(1)), is = measure_quality(after, Threads(1));
  EXPECT_NEAR(is.volume, was.volume, 1e-14);
  EXPECT_GT(is.min_volume, 0);
  EXPECT_EQ(boundary_faces(after).size(), boundary_faces(before).size());
}

TEST(AngleMeasure, IsOneAtTheTargetsAndFlatWithoutVolume) {
  const double regular = std::acos(1.0 / 3.0) * 180 / std::numbers::pi;
  const TetCorners tet{Vec3(1, 1, 1), Vec3(-1, 1, -1), Vec3(1, -1, -1), Vec3(-1, -1, 1)};
  EXPECT_NEAR(AngleMeasure(regular, 170).quality(tet), 1, 1e-14);
  EXPECT_GT(AngleMeasure(regular - 1, 170).quality(tet), 1);
  EXPECT_LT(AngleMeasure(regular + 1, 170).quality(tet), 1);
  // A corner of a cube: angles of 90 and of acos(1 / sqrt(3)) degrees.
  const TetCorners corner{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  EXPECT_NEAR(AngleMeasure(std::acos(1 / std::sqrt(3.0)) * 180 / std::numbers::pi, 100).quality(corner), 1, 1e-14);
  EXPECT_NEAR(AngleMeasure(10, 90).quality(corner), 1, 1e-14);
  EXPECT_EQ(AngleMeasure(10, 90).quality(TetCorners{corner[0], corner[2], corner[1], corner[3]}), AngleMeasure::kFlat);
  EXPECT_EQ(AngleMeasure(10, 90).quality(TetCorners{corner[0], corner[1], corner[2], Vec3(0.3, 0.3, 0)}),
            AngleMeasure::kFlat);
  // Far from the origin the last digits of a position are as large as this element is high.
  const Vec3 far = Vec3::Constant(1e6);
  EXPECT_EQ(AngleMeasure(10, 90).quality(
                TetCorners{far, far + Vec3::UnitX(), far + Vec3::UnitY(), far + Vec3(0.3, 0.3, 1e-17)}),
            AngleMeasure::kFlat);
}

TEST(AngleMeasure, TakesNothingWorseThanWhatItAdmitted) {
  const TetCorners corner{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  const TetCorners low{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3(0, 0, 0.9)};
  AngleMeasure measure(60, 95);
  measure.admit(dihedral_cosines(corner));
  EXPECT_GT(measure.new_quality(corner), 0);
  EXPECT_EQ(measure.new_quality(low), AngleMeasure::kFlat);
  EXPECT_GT(measure.quality(low), 0);
  measure.admit(dihedral_cosines(low));
  EXPECT_GT(measure.new_quality(low), 0);
}

TEST(Flips, TwoRegularTetrahedraComeFromThree) {
  const TetMesh before = round_edge(3, std::sqrt(2.0));
  Work work(before);
  EXPECT_TRUE(work.flips.remove_edge(0, 1));
  work.tets.compact();
  EXPECT_EQ(work.mesh.tets.size(), 2u);
  expect_same_room(work.mesh, before);
  const TetQuality quality = measure_quality(work.mesh, Threads(1));
  EXPECT_NEAR(quality.min_dihedral, std::acos(1.0 / 3.0) * 180 / std::numbers::pi, 1e-10);
  EXPECT_NEAR(quality.max_dihedral, quality.min_dihedral, 1e-10);
}

TEST(Flips, TwoFlatTetrahedraBecomeThree) {
  const TetMesh before = at_triangle(0.2);
  for (const Index apex : {0, 1}) {
    Work work(before);
    EXPECT_TRUE(work.flips.remove_face(apex == 1 ? 0 : 1, apex));
    work.tets.compact();
    EXPECT_EQ(work.mesh.tets.size(), 3u);
    EXPECT_TRUE(has_edge(work.mesh, 0, 1));
    expect_same_room(work.mesh, before);
    // at an edge of the triangle both heights over half the radius
    EXPECT_NEAR(measure_quality(work.mesh, Threads(1)).min_dihedral, 2 * std::atan(0.4) * 180 / std::numbers::pi, 1e-9);
  }
}

TEST(Flips, AnOctahedronIsSplitAlongItsShortAxis) {
  for (const int axis : {0, 1}) {
    TetMesh before = round_edge(4, 1);
    for (Vec3& x : before.nodes) x[axis] *= 0.7;
    Work work(before);
    EXPECT_TRUE(work.flips.remove_edge(0, 1));
    work.tets.compact();
    EXPECT_EQ(work.mesh.tets.size(), 4u);
    EXPECT_TRUE(has_edge(work.mesh, axis == 0 ? 2 : 3, axis == 0 ? 4 : 5));
    EXPECT_FALSE(has_edge(work.mesh, 0, 1));
    expect_same_room(work.mesh, before);
  }
}

TEST(Flips, LongEdgesGoUpToSevenElementsAndShortOnesStay) {
  for (const int n : {5, 6, 7, 8}) {
    const TetMesh tall = round_edge(n, 5);
    Work work(tall);
    EXPECT_EQ(work.flips.remove_edge(0, 1), n <= 7) << n;
    work.tets.compact();
    EXPECT_EQ(work.mesh.tets.size(), static_cast<std::size_t>(n <= 7 ? 2 * (n - 2) : n));
    expect_same_room(work.mesh, tall);
  }
  const TetMesh low = round_edge(5, 0.6);
  Work work(low);
  EXPECT_FALSE(work.flips.remove_edge(0, 1));
  EXPECT_EQ(work.mesh.tets, low.tets);
}

TEST(Flips, EdgesAndFacesOfTheBoundaryStay) {
  TetMesh fan = round_edge(4, 5);
  fan.tets.pop_back();
  Work work(fan);
  for (Index a = 0; a < 6; ++a)
    for (Index b = 0; b < a; ++b) EXPECT_FALSE(work.flips.remove_edge(a, b));
  EXPECT_FALSE(work.flips.remove_face(0, 0));
  EXPECT_EQ(work.mesh.tets, fan.tets);
}

TEST(Flips, AFaceStaysWhereTheNewEdgeWouldRunOutside) {
  TetMesh mesh = at_triangle(0.2);
  mesh.nodes[0] += Vec3(-1.2, 0, 0);
  mesh.nodes[1] += Vec3(-1.2, 0, 0);
  const TetMesh before = mesh;
  Work work(mesh);
  EXPECT_FALSE(work.flips.remove_face(0, 1));
  EXPECT_EQ(work.mesh.tets, before.tets);
}

TEST(Flips, ARingThatIsNotConvexIsSplitAtItsInnerCorner) {
  // Node 3 is pushed behind the line between its neighbours 2 and 4: only the line from it to node 5 is inside.
  TetMesh before = round_edge(4, 3);
  before.nodes[2] = Vec3(1, -0.4, 0);
  before.nodes[3] = Vec3(0.1, 0.1, 0);
  before.nodes[4] = Vec3(-0.4, 1, 0);
  ASSERT_GT(measure_quality(before, Threads(1)).min_volume, 0);
  Work work(before);
  EXPECT_TRUE(work.flips.remove_edge(0, 1));
  work.tets.compact();
  EXPECT_TRUE(has_edge(work.mesh, 3, 5));
  EXPECT_FALSE(has_edge(work.mesh, 2, 4));
  expect_same_room(work.mesh, before);
}

TEST(NodeSmoothing, FindsTheMiddleOfAnOctahedron) {
  TetMesh mesh;
  mesh.nodes = {Vec3(0.4, -0.3, 0.25)};
  for (int k = 0; k < 3; ++k)
    for (const double side : {-1.0, 1.0}) mesh.nodes.emplace_back(side * Vec3::Unit(k));
  for (Index x : {1, 2})
    for (Index y : {3, 4})
      for (Index z : {5, 6}) {
        const bool odd = (x + y + z) % 2 != 0;
        mesh.tets.push_back({0, x, odd ? z : y, odd ? y : z});
      }
  ASSERT_GT(measure_quality(mesh, Threads(1)).min_volume, 0);
  Work work(mesh);
  const std::vector<bool> inside(7, false);
  NodeSmoothing smoothing(work.tets, nullptr, inside);
  EXPECT_TRUE(smoothing.improve(0));
  // Corners of cubes: the least angle is acos(1 / sqrt(3)).
  EXPECT_GT(measure_quality(work.mesh, Threads(1)).min_dihedral, 54.74 - 1.5);
  EXPECT_LT(work.mesh.nodes[0].norm(), 0.05);
  EXPECT_FALSE(smoothing.improve(0) && smoothing.improve(0) && smoothing.improve(0));
}

TEST(NodeSmoothing, LeavesTheBoundaryWithoutASurface) {
  TetMesh mesh = at_triangle(0.2);
  Work work(mesh);
  const std::vector<bool> boundary(5, true);
  NodeSmoothing smoothing(work.tets, nullptr, boundary);
  for (Index node = 0; node < 5; ++node) EXPECT_FALSE(smoothing.improve(node));
  EXPECT_EQ(work.mesh.nodes, mesh.nodes);
}

}  // namespace
}  // namespace softreel
