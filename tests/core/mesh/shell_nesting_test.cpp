// Closed shells inside of open ones keep their orientation relative to them.
#include "core/mesh/shell_nesting.h"

#include <gtest/gtest.h>

#include "core/mesh/mesh_repair.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

/// A ball of radius 1 that ends at a neck, y = `neck`.
SurfaceMesh make_head(double neck) {
  SurfaceMesh head = test::make_sphere(1, 16, Vec3::Zero());
  std::erase_if(head.triangles,
                [&](const Triangle& t) { return head.positions[static_cast<std::size_t>(t[0])].y() < neck; });
  return head;
}

SurfaceMesh inside_out(SurfaceMesh mesh, bool is_turned) {
  if (is_turned) test::turn_inside_out(mesh);
  return mesh;
}

const Vec3 kEye(0.3, 0.3, 0.6), kOtherEye(-0.3, 0.3, 0.6);

TEST(FindInvertedShells, LeavesEyesInAnOpenHeadAsTheyStandToIt) {
  for (const bool head_inward : {false, true})
    for (const bool eyes_inward : {false, true}) {
      SurfaceMesh mesh = inside_out(make_head(-0.6), head_inward);
      for (const Vec3& eye : {kEye, kOtherEye})
        test::append(mesh, inside_out(test::make_sphere(0.15, 4, eye), eyes_inward));
      const std::vector<Triangle> given = mesh.triangles;
      EXPECT_TRUE(repair_mesh(mesh).empty()) << head_inward << eyes_inward;
      EXPECT_EQ(mesh.triangles, given) << head_inward << eyes_inward;
    }
}

TEST(FindInvertedShells, TurnsWhatLiesBesideAnOpenPiece) {
  for (const Vec3& place : {Vec3(0.8, 0.5, 0.8), Vec3(5, 0, 0)}) {
    SurfaceMesh mesh = make_head(-0.3);
    test::append(mesh, inside_out(test::make_sphere(0.1, 4, place), true));
    EXPECT_EQ(repair_mesh(mesh), std::vector<std::string>({"1 of 2 pieces turned outward"})) << place.transpose();
  }
}

TEST(FindInvertedShells, AsksTheInnermostOfOpenAndClosedPieces) {
  // A pupil in an eye in the head: the eye stays, so does what is in it.
  SurfaceMesh mesh = inside_out(make_head(-0.6), true);
  test::append(mesh, inside_out(test::make_sphere(0.2, 4, kEye), true));
  test::append(mesh, inside_out(test::make_sphere(0.05, 4, kEye), true));
  EXPECT_TRUE(repair_mesh(mesh).empty());
  // A head in a helmet: that is turned, the head is not, and the eye goes with the head.
  test::append(mesh, inside_out(test::make_sphere(2, 8, Vec3::Zero()), true));
  EXPECT_EQ(repair_mesh(mesh), std::vector<std::string>({"1 of 4 pieces turned outward"}));
}

/// Inward shells all over an open ball, and as many small open pieces between them.
TEST(FindInvertedShells, TellsThousandsOfShellsInAnOpenPiece) {
  SurfaceMesh mesh = inside_out(make_head(-0.8), true);
  constexpr Index kSide = 24;
  for (Index k = 0; k < kSide * kSide * kSide; ++k) {
    const Vec3 p = Vec3(k % kSide, k / kSide % kSide, k / kSide / kSide) / kSide - Vec3::Constant(0.5);
    const auto first = static_cast<Index>(mesh.positions.size());
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
      mesh.positions.push_back(p + 0.3 / kSide * corner);
    for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 3, 1}, Triangle{0, 2, 3}, Triangle{1, 3, 2}})
      if (k % 2 == 0 || t[2] != 2) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  const std::vector<Triangle> given = mesh.triangles;
  EXPECT_TRUE(repair_mesh(mesh).empty());
  EXPECT_EQ(mesh.triangles, given);
}

}  // namespace
}  // namespace softreel
