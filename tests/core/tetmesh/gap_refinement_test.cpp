#include "core/tetmesh/graded/gap_refinement.h"

#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "core/tetmesh/graded/graded_stuffing.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

/// A ball of radius 1 in an octree whose leaves at the surface are of level 2.
struct GradedBall {
  GradedBall() : surface(test::make_sphere(1, 24, Vec3::Zero())), sampler(surface.positions, surface.triangles) {
    const Bounds box = used_bounds(surface);
    octree.emplace(LatticeFrame{Vec3(0.01, 0.02, 0.03), 0.03}, box, 4);
    for (const auto& [a, b, c] : surface.triangles) octree->refine({at(a), at(b), at(c)}, 2);
    stuff();
  }

  const Vec3& at(Index vertex) const { return surface.positions[static_cast<std::size_t>(vertex)]; }

  void stuff() {
    const LatticeNodeSet nodes = octree->nodes();
    distance = sampler.sample(octree->frame(), nodes, octree->widths(nodes), {}, Threads(1));
    stuffed = stuff_octree(*octree, nodes, distance.lattice.values);
  }
  double count() const { return static_cast<double>(stuffed.mesh.tets.size()); }

  SurfaceMesh surface;
  DistanceSampler sampler;
  std::optional<GradedOctree> octree;
  SurfaceDistance distance;
  StuffedMesh stuffed;
};

/// A gap of this width at the surface of the ball in a direction.
BoundaryGap gap_at(const Vec3& direction, double width) {
  const Vec3 out = direction.normalized();
  return {out, (1 - width) * out, {-1, -1, -1}};
}

/// Gaps all over the ball, the widest first.
std::vector<BoundaryGap> many_gaps() {
  std::mt19937 random(5);
  std::normal_distribution<double> value;
  std::vector<BoundaryGap> gaps;
  for (int k = 0; k < 2000; ++k)
    gaps.push_back(gap_at(Vec3(value(random), value(random), value(random)), 0.02 - 1e-5 * k));
  return gaps;
}

TEST(WidestReachable, LeavesOutGapsWhoseLeavesAreTheFinest) {
  GradedBall ball;
  const std::vector<BoundaryGap> gaps{gap_at(Vec3(1, 0, 0), 0.02), gap_at(Vec3(-1, 0, 0), 0.01)};
  EXPECT_DOUBLE_EQ(widest_reachable(*ball.octree, gaps, {}), width_of(gaps[0]));
  ball.octree->refine(gaps[0].on_surface, 0, 0.1);
  EXPECT_DOUBLE_EQ(widest_reachable(*ball.octree, gaps, {}), width_of(gaps[1]));
  ball.octree->refine(gaps[1].on_surface, 0, 0.1);
  EXPECT_EQ(widest_reachable(*ball.octree, gaps, {}), 0.0);
}

TEST(RefineWidest, AddsAboutAsManyTetrahedraAsItExpects) {
  for (const double share : {0.2, 0.6, 1.2}) {
    SCOPED_TRACE(share);
    GradedBall ball;
    const double before = ball.count();
    const WidestRefined done =
        refine_widest(*ball.octree, many_gaps(), ball.stuffed.mesh.nodes, ball.distance, {share * before});
    EXPECT_GE(done.added_tets, share * before);
    EXPECT_LT(done.added_tets, (share + 0.1) * before);
    EXPECT_GT(done.narrowest, 0);
    ball.stuff();
    EXPECT_NEAR((ball.count() - before) / done.added_tets, 1, 0.35);
  }
}

TEST(RefineWidest, TakesTheWidestFirst) {
  GradedBall ball;
  const std::vector<BoundaryGap> gaps{gap_at({1, 0, 0}, 0.02), gap_at({-1, 0, 0}, 0.01)};
  const WidestRefined done = refine_widest(*ball.octree, gaps, ball.stuffed.mesh.nodes, ball.distance, {1});
  EXPECT_GT(done.halved, 0U);
  EXPECT_NEAR(done.narrowest, 0.02, 1e-12);
  EXPECT_EQ(ball.octree->level_at(gaps[0].on_surface), 1);
  EXPECT_EQ(ball.octree->level_at(gaps[1].on_surface), 2);
}

TEST(RefineWidest, HalvesALeafOnceHoweverManyGapsAreInIt) {
  GradedBall ball;
  const std::vector<BoundaryGap> gaps(5, gap_at({1, 0, 0}, 0.001));
  refine_widest(*ball.octree, gaps, ball.stuffed.mesh.nodes, ball.distance, {1e300});
  EXPECT_EQ(ball.octree->level_at(gaps[0].on_surface), 1);
}

TEST(RefineWidest, HalvesTwiceWhereGapsAreVeryWide) {
  GradedBall ball;
  const std::vector<BoundaryGap> gaps{gap_at({1, 0, 0}, 0.02), gap_at({-1, 0, 0}, 0.01)};
  refine_widest(*ball.octree, gaps, ball.stuffed.mesh.nodes, ball.distance, {1e300, 0.015});
  EXPECT_EQ(ball.octree->level_at(gaps[0].on_surface), 0);
  EXPECT_EQ(ball.octree->level_at(gaps[1].on_surface), 1);
}

TEST(RefineWidest, EndsAtTheFinestLeaves) {
  GradedBall ball;
  const std::vector<BoundaryGap> gaps{gap_at({1, 0, 0}, 0.001)};
  for (int level = 1; level >= 0; --level) {
    EXPECT_GT(refine_widest(*ball.octree, gaps, ball.stuffed.mesh.nodes, ball.distance, {1e300}).halved, 0U);
    EXPECT_EQ(ball.octree->level_at(gaps[0].on_surface), level);
    ball.stuff();
  }
  EXPECT_EQ(refine_widest(*ball.octree, gaps, ball.stuffed.mesh.nodes, ball.distance, {1e300}).halved, 0U);
}

}  // namespace
}  // namespace softreel
