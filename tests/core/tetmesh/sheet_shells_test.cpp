/// The skin of a sheet with a thickness is closed, however the sheet is folded.
#include "core/tetmesh/surface/sheet_shells.h"

#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "core/mesh/winding_number.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

/// A square sheet whose vertices are up to `height` of its cells off its plane, so that it is folded sharply between
/// them; triangles are turned round at random.
SurfaceMesh crumpled_sheet(Index cells, double height, unsigned seed) {
  std::mt19937 random(seed);
  const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
  SurfaceMesh sheet;
  for (Index i = 0; i <= cells; ++i)
    for (Index j = 0; j <= cells; ++j) sheet.positions.push_back(Vec3(i, j, height * share()));
  test::each_grid_triangle(cells, [&](Index a, Index b, Index c) {
    if (share() < 0.5) std::swap(b, c);
    sheet.triangles.push_back({a, b, c});
  });
  return sheet;
}

TEST(ThickenSheets, ClosesTheSkinOfSharplyFoldedSheets) {
  for (const double height : {0.1, 1.0, 4.0, 16.0})
    for (unsigned seed = 0; seed < 8; ++seed) {
      SurfaceMesh sheet = crumpled_sheet(12, height, seed);
      EXPECT_FALSE(has_integer_windings(sheet.positions, sheet.triangles));
      EXPECT_EQ(thicken_sheets(sheet, find_parts(sheet), 0.05), 2 * 12 * 12);
      EXPECT_TRUE(has_integer_windings(sheet.positions, sheet.triangles)) << "height " << height << ", seed " << seed;
    }
}

TEST(ThickenSheets, FlatSheetsGetTwoSidesAndAWallAlongTheRimOnly) {
  SurfaceMesh sheet = crumpled_sheet(5, 0, 1);
  thicken_sheets(sheet, find_parts(sheet), 0.05);
  EXPECT_EQ(sheet.triangles.size(), 2U * 50 + 2 * 20);
}

}  // namespace
}  // namespace softreel
