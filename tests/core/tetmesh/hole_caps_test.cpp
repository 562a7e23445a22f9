#include "core/tetmesh/surface/hole_caps.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/tetmesh/filling/tetrahedralize.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

/// A unit ball's sphere without what lies below y = `height`.
SurfaceMesh holed_sphere(double height) {
  SurfaceMesh surface = test::make_sphere(1, 32, Vec3::Zero());
  std::erase_if(surface.triangles, [&](const Triangle& triangle) {
    return std::ranges::all_of(triangle,
                               [&](Index v) { return surface.positions[static_cast<std::size_t>(v)][1] < height; });
  });
  return surface;
}

TetMesh fill(const SurfaceMesh& surface, const TetrahedralizeParams& params,
             std::vector<std::string>* lines = nullptr) {
  const auto collect = [&](const std::string& line) {
    if (lines != nullptr) lines->push_back(line);
  };
  StageTimes times;
  return tetrahedralize(surface, params, "ball", Threads(1), {collect, collect}, times);
}

TEST(HoleCaps, AreNowhereRoundAClosedSurface) {
  const SurfaceMesh ball = test::make_sphere(1, 16, Vec3::Zero());
  const TriangleTree tree(ball.positions, ball.triangles);
  const HoleCaps caps(ball.positions, ball.triangles, tree);
  EXPECT_FALSE(caps.any());
  EXPECT_FALSE(caps.contain(Vec3(0.1, 0, 0)));
}

TEST(HoleCaps, AreWhereTheWindingNumberPassesAHalfOffTheSurface) {
  // Of a hemisphere the half is passed on its disk, by symmetry with the missing half.
  const SurfaceMesh half = holed_sphere(1e-6);
  const TriangleTree tree(half.positions, half.triangles);
  const HoleCaps caps(half.positions, half.triangles, tree);
  ASSERT_TRUE(caps.any());
  EXPECT_TRUE(caps.contain(Vec3(0, -0.02, 0)));
  EXPECT_TRUE(caps.contain(Vec3(0.5, 0.02, 0.3)));
  EXPECT_FALSE(caps.contain(Vec3(0, 0.7, 0)));     // deep inside
  EXPECT_FALSE(caps.contain(Vec3(0, 1.3, 0)));     // far outside
  EXPECT_FALSE(caps.contain(Vec3(0.97, 0.3, 0)));  // beside the surface
  EXPECT_FALSE(caps.contain(half.positions[static_cast<std::size_t>(half.triangles[0][0])]));
}

TEST(MeasureDeviation, OfABallWithAHoleIsThatOfTheRest) {
  const double edge = 0.12;
  const double closed = [&] {
    const SurfaceMesh ball = test::make_sphere(1, 32, Vec3::Zero());
    const SurfaceDeviation deviation = measure_deviation(ball, fill(ball, {.edge = edge}), Threads(1));
    EXPECT_EQ(deviation.cap_share, 0);
    return deviation.two_way();
  }();
  for (const double height : {-0.85, -0.5, 0.0}) {
    SCOPED_TRACE(height);
    const SurfaceMesh ball = holed_sphere(height);
    const TetMesh mesh = fill(ball, {.edge = edge});
    const SurfaceDeviation deviation = measure_deviation(ball, mesh, Threads(1));
    // At the rim the surface ends inside an element; the middle of the cap is as far away as the hole is wide.
    EXPECT_LT(deviation.two_way(), closed + 0.5 * edge);
    // The cap is a little larger than the disk that closes the hole, and less than the sphere's own.
    const double disk = 1 - height * height, open = 2 * (1 - height), cap = 2 * (1 + height);
    EXPECT_GT(deviation.cap_share, 0.75 * disk / (disk + open));
    EXPECT_LT(deviation.cap_share, 1.1 * cap / (cap + open));
  }
}

TEST(MeasureDeviation, CountsWhatIsWrongBesideAHole) {
  // The mesh is that of a smaller ball: nearer to the hole than its cap is to the surface, and wrong all the same.
  const SurfaceMesh holed = holed_sphere(-0.85);
  const TetMesh small = fill(test::make_sphere(0.7, 24, Vec3::Zero()), {.edge = 0.12});
  const SurfaceDeviation deviation = measure_deviation(holed, small, Threads(1));
  EXPECT_GT(deviation.from_boundary, 0.29);
  EXPECT_GT(deviation.from_surface, 0.29);
  // A ball that the surface lacks is no cap either.
  TetMesh more = fill(holed, {.edge = 0.12});
  const TetMesh extra = fill(test::make_sphere(0.3, 12, Vec3(3, 0, 0)), {.edge = 0.12});
  const auto first = static_cast<Index>(more.nodes.size());
  more.nodes.insert(more.nodes.end(), extra.nodes.begin(), extra.nodes.end());
  for (const auto& [a, b, c, d] : extra.tets) more.tets.push_back({a + first, b + first, c + first, d + first});
  EXPECT_NEAR(measure_deviation(holed, more, Threads(1)).from_boundary, 2.3, 0.05);
}

TEST(FillToError, KeepsToItsBudgetBesideAHole) {
  const SurfaceMesh ball = holed_sphere(-0.85);
  std::vector<std::string> lines;
  const TetMesh mesh = fill(ball, {.error = 0.02}, &lines);
  EXPECT_LE(measure_deviation(ball, mesh, Threads(1)).two_way(), 0.02);
  EXPECT_TRUE(lines.empty()) << lines.front();
}

}  // namespace
}  // namespace softreel
