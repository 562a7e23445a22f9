#include <gtest/gtest.h>

#include "tests/core/mesh/mesh_files.h"

namespace softreel {
namespace {

using testing::import_error;
using testing::import_text;

TEST(OffReader, ReadsVerticesAndPolygonsInFileOrder) {
  const SurfaceMesh mesh =
      import_text("a.off", "OFF # a square\n5 1 0\n\n9 9 9\n0 0 0\n1 0 0 # corner\n1 1 0\n0 1 0\n4 1 2 3 4 255 0 0");
  ASSERT_EQ(mesh.positions.size(), 5U);
  EXPECT_EQ(mesh.positions[0], Vec3(9, 9, 9));
  EXPECT_EQ(mesh.polygons.corner_vertices, std::vector<Index>({1, 2, 3, 4}));
  EXPECT_EQ(mesh.triangles.size(), 2U);
}

TEST(OffReader, TakesHeadersOnOneLineWithoutKeywordOrWithColours) {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(import_text("a.off", "OFF 3 1 0\n" + body).triangles.size(), 1U);
  EXPECT_EQ(import_text("a.off", "3 1\r\n" + body).triangles.size(), 1U);
  EXPECT_EQ(
      import_text("a.off", "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n").positions[1],
      Vec3(1, 0, 0));
  const SurfaceMesh textured = import_text("a.off", "STOFF\n3 1 0\n0 0 0 .5 .25\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n");
  EXPECT_EQ(textured.texture_coordinates[0], Vec2(0.5, 0.25));
  EXPECT_EQ(textured.triangle_textures, std::vector<Triangle>({{0, 1, 2}}));
}

TEST(OffReader, SaysWhichLineIsWrong) {
  EXPECT_NE(import_error("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n").find("ends before vertex 3 of 3"), std::string::npos);
  EXPECT_NE(import_error("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n").find("face 1 of 1"), std::string::npos);
  EXPECT_NE(import_error("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n").find("a.off:6:"), std::string::npos);
  EXPECT_NE(import_error("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n").find("a.off:6:"), std::string::npos);
  EXPECT_NE(import_error("a.off", "OFF\n3 1 0\n0 0 0\n1 zero 0\n").find("'zero'"), std::string::npos);
  EXPECT_NE(import_error("a.off", "OFF BINARY\n1 1 1\n").find("binary"), std::string::npos);
  EXPECT_NE(import_error("a.off", "4OFF\n3 1 0\n").find("4OFF"), std::string::npos);
  EXPECT_NE(import_error("a.off", "Once upon a time\n").find("'Once'"), std::string::npos);
  EXPECT_NE(import_error("a.off", "OFF\n2000000000 1 0\n0 0 0\n").find("vertex 2 of"), std::string::npos);
}

}  // namespace
}  // namespace softreel
