/// What is left out of triangles, whatever its size and place on them.
#include "core/tetmesh/surface/surface_pieces.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

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
  const auto in_disk = [&](const std::array<Vec3, 3>&, const Vec3& p) { return (p - center).norm() < radius; };
  return without_pieces(kCorners, {{0, 1, 2}}, {1}, {step, 4 * step}, in_disk, Threads(1));
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
  const auto outside = [](const std::array<Vec3, 3>&, const Vec3& p) { return (p - Vec3(2.4, 0.5, 0)).norm() >= 0.4; };
  const double disk = std::numbers::pi * 0.16;
  EXPECT_NEAR(area_of(without_pieces(kCorners, {{0, 1, 2}}, {1}, {0.1, 0.4}, outside, Threads(1))), disk, 0.3 * disk);
}

TEST(SurfacePieces, AreWholeTrianglesWhereNothingIsLeftOut) {
  EXPECT_EQ(without_disk(Vec3(9, 9, 0), 1, 0.01).triangles.size(), 1U);
  EXPECT_EQ(without_disk(Vec3(0, 0, 0), 99, 0.01).triangles.size(), 0U);
  const auto all = [](const std::array<Vec3, 3>&, const Vec3&) { return true; };
  EXPECT_EQ(without_pieces(kCorners, {{0, 1, 2}}, {0}, {0.01}, all, Threads(1)).triangles.size(), 1U) << "unsuspected";
}

}  // namespace
}  // namespace softreel
