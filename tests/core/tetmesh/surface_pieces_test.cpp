/// What is left out of triangles, whatever its size and place on them.
#include "core/tetmesh/surface/surface_pieces.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/tetmesh/surface/hidden_surface.h"
#include "tests/support/damaged_shapes.h"

namespace softreel {
namespace {

const std::vector<Vec3> kCorners{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 3, 0)};
constexpr double kArea = 6;

double area_of(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](Index v) { return mesh.positions[static_cast<std::size_t>(v)]; };
    sum += 0.5 * (at(b) - at(a)).cross(at(c) - at(a)).norm();
  }
  return sum;
}

SurfaceMesh without_disk(const Vec3& center, double radius, double step) {
  PieceRules rules;
  rules.leaves_out = [&](const TriangleCorners&, const Vec3& p) { return (p - center).norm() < radius; };
  rules.border = step;
  rules.trusted = 4 * step;
  return without_pieces(kCorners, {{0, 1, 2}}, {1}, rules, Threads(1));
}

TEST(SurfacePieces, LeaveOutWhatLiesInsideATriangleAndReachesNoCorner) {
  // Neither the middle, (4/3, 1), nor any corner is in these.
  for (const Vec3& center : {Vec3(2.4, 0.5, 0), Vec3(0.5, 1.9, 0), Vec3(0.6, 0.6, 0)})
    for (const double radius : {0.4, 0.2}) {
      const double step = 0.25 * radius, disk = std::numbers::pi * radius * radius;
      EXPECT_NEAR(area_of(without_disk(center, radius, step)), kArea - disk, 0.3 * disk) << radius;
    }
}

TEST(SurfacePieces, KeepWhatReachesNoCornerAroundWhatIsLeftOut) {
  // All but a disk is left out; the corners and the middle are.
  PieceRules rules;
  rules.leaves_out = [](const TriangleCorners&, const Vec3& p) { return (p - Vec3(2.4, 0.5, 0)).norm() >= 0.4; };
  rules.border = 0.1;
  rules.trusted = 0.4;
  const double disk = std::numbers::pi * 0.16;
  EXPECT_NEAR(area_of(without_pieces(kCorners, {{0, 1, 2}}, {1}, rules, Threads(1))), disk, 0.3 * disk);
}

TEST(SurfacePieces, AreWholeTrianglesWhereNothingIsLeftOut) {
  EXPECT_EQ(without_disk(Vec3(9, 9, 0), 1, 0.01).triangles.size(), 1U);
  EXPECT_EQ(without_disk(Vec3(0, 0, 0), 99, 0.01).triangles.size(), 0U);
  PieceRules all;
  all.leaves_out = [](const TriangleCorners&, const Vec3&) { return true; };
  all.border = 0.01;
  EXPECT_EQ(without_pieces(kCorners, {{0, 1, 2}}, {0}, all, Threads(1)).triangles.size(), 1U) << "unsuspected";
}

TEST(SurfacePieces, OfOverlappingBlocksAreWithoutWhatIsHiddenInsideLargeTriangles) {
  // A rod through the middle of the top of a block, as far from all corners of its two triangles as it can be.
  const SurfaceMesh block = test::block(Vec3(1, 0.2, 1), Vec3::Zero());
  const SurfaceMesh rod = test::block(Vec3(0.05, 0.3, 0.05), Vec3(0.45, 0.3, -0.2));
  const SurfaceMesh both = test::with(block, rod);
  const SurfaceMesh visible =
      without_hidden(both, std::vector<std::uint8_t>(both.triangles.size(), 1), 0.01, Threads(1));
  const double hidden = 0.1 * 0.1 + 4 * 0.1 * 0.2 + 0.1 * 0.1;  // the hole, and of the rod its sides and one end
  EXPECT_NEAR(area_of(visible), area_of(both) - hidden, 0.01 * 1.0);
  EXPECT_LT(visible.triangles.size(), 3000U) << "what nothing crosses stays whole";
}

}  // namespace
}  // namespace softreel
