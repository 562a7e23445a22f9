#include "core/mesh/placement.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/core/mesh/mesh_files.h"

namespace softreel {
namespace {

SurfaceMesh tall_box() {
  SurfaceMesh mesh;
  testing::add_box(mesh, Vec3(10, 20, 30), Vec3(11, 22, 34));
  mesh.positions.emplace_back(1e6, -1e6, 1e6);  // used by no face
  return mesh;
}

TEST(Place, TurnsTheUpAxisToYByAProperRotation) {
  using Up = PlacementParams::Up;
  for (const auto& [up, axis] : {std::pair{Up::X, Vec3::UnitX().eval()}, std::pair{Up::Y, Vec3::UnitY().eval()},
                                 std::pair{Up::Z, Vec3::UnitZ().eval()}}) {
    const Placement placement = place(tall_box(), {.up = up});
    EXPECT_EQ(placement(axis), Vec3::UnitY());
    EXPECT_EQ(placement.linear.determinant(), 1);
    EXPECT_EQ(placement.linear * placement.linear.transpose(), Mat3::Identity());
  }
}

TEST(Place, FitsTheHeightAndStandsTheBodyOnTheGround) {
  for (const auto up : {PlacementParams::Up::X, PlacementParams::Up::Y, PlacementParams::Up::Z}) {
    SurfaceMesh mesh = tall_box();
    apply(place(mesh, {.up = up, .fit = 1.5}), mesh);
    const Bounds bounds = used_bounds(mesh);
    EXPECT_NEAR(bounds.min.y(), 0, 1e-14);
    EXPECT_NEAR(bounds.max.y(), 1.5, 1e-14);
    EXPECT_NEAR(bounds.center().x(), 0, 1e-14);
    EXPECT_NEAR(bounds.center().z(), 0, 1e-14);
  }
}

TEST(Place, RotatesAboutXThenYThenZAndTranslatesLast) {
  const double quarter = std::numbers::pi / 2;
  const Placement placement =
      place(tall_box(), {.scale = 2, .translate = Vec3(5, 0, 0), .rotate_rad = Vec3(quarter, quarter, 0)});
  // y goes to z by the first turn, z to x by the second.
  EXPECT_TRUE(placement(Vec3::UnitY()).isApprox(Vec3(7, 0, 0), 1e-14));
  EXPECT_TRUE(placement(Vec3::UnitX()).isApprox(Vec3(5, 0, -2), 1e-14));
}

TEST(Place, RefusesAFlatBodyAndSizesThatAreNone) {
  SurfaceMesh sheet = testing::make_mesh({{0, 3, 0}, {1, 3, 0}, {0, 3, 1}}, {{0, 1, 2}});
  EXPECT_NO_THROW(place(sheet, {.up = PlacementParams::Up::Z, .fit = 1}));
  try {
    place(sheet, {.fit = 1});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("fit = 1 cannot be reached"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("Accepted"), std::string::npos);
  }
  EXPECT_THROW(place(sheet, {.fit = -1}), Error);
  EXPECT_THROW(place(sheet, {.scale = 0}), Error);
}

TEST(UndoPlacement, GivesTheFileBackBitForBitWhereNothingMoved) {
  const SurfaceMesh file = tall_box();
  SurfaceMesh scene = file;
  const Placement placement = place(
      file, {.up = PlacementParams::Up::Z, .fit = 0.7, .translate = Vec3(1, 2, 3), .rotate_rad = Vec3(0.3, -2, 1)});
  apply(placement, scene);
  for (std::size_t v = 0; v < file.positions.size(); ++v) {
    const Vec3 &p = file.positions[v], &rest = scene.positions[v];
    EXPECT_EQ(undo(placement, p, rest, rest), p);
    const Vec3 moved = p + Vec3(0.25, -0.5, 1);
    EXPECT_LT((undo(placement, p, rest, placement(moved)) - moved).norm(), 1e-14 * (1 + p.norm()));
  }
}

}  // namespace
}  // namespace softreel
