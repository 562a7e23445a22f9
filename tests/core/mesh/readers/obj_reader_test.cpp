#include <gtest/gtest.h>

#include "core/base/srgb.h"
#include "tests/core/mesh/mesh_files.h"

namespace softreel {
namespace {

using testing::import_error;
using testing::import_text;

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ObjReader, KeepsVerticesInFileOrderWithUnusedOnesAndAllBits) {
  const SurfaceMesh mesh = import_text("a.obj", "v 9 9 9\nv 0.1 -1e-3 +3\nv 1 0 0 0.5 0.5 0.5\nv 0 1 .5\nf 2 3 4\n");
  ASSERT_EQ(mesh.positions.size(), 4U);
  EXPECT_EQ(mesh.positions[0], Vec3(9, 9, 9));
  EXPECT_EQ(mesh.positions[1], Vec3(0.1, -1e-3, 3));
  EXPECT_EQ(mesh.positions[3], Vec3(0, 1, 0.5));
  EXPECT_EQ(mesh.triangles, std::vector<Triangle>({{1, 2, 3}}));
}

TEST(ObjReader, ReadsColoursAfterThePlaceAndMakesThemLinear) {
  const SurfaceMesh mesh = import_text("a.obj", "v 0 0 0\nv 1 0 0 1 0.5 0\nv 0 1 0 0.25\nv 0 0 1\nf 1 2 3\n");
  ASSERT_EQ(mesh.colors.size(), 4U) << "one for every vertex as soon as one has some";
  EXPECT_EQ(mesh.colors[0], Vec3f(1, 1, 1));
  EXPECT_EQ(mesh.colors[1], Vec3f(1, srgb_decode(0.5f), 0));
  EXPECT_EQ(mesh.colors[2], Vec3f(1, 1, 1)) << "a single number is a weight";
  EXPECT_TRUE(import_text("b.obj", std::string(kSquare) + "f 1 2 3\n").colors.empty());
}

TEST(ObjReader, KeepsPolygonsAndTextureCoordinatesPerCorner) {
  const SurfaceMesh mesh =
      import_text("a.obj", std::string(kSquare) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/4 2/3/1 3/2 4/1\nf 1//1 2 3\n");
  EXPECT_EQ(mesh.polygons.offsets, std::vector<Index>({0, 4, 7}));
  EXPECT_EQ(mesh.polygons.corner_textures, std::vector<Index>({3, 2, 1, 0, -1, -1, -1}));
  ASSERT_EQ(mesh.triangles.size(), 3U);
  EXPECT_EQ(mesh.triangle_polygon, std::vector<Index>({0, 0, 1}));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(mesh.triangle_textures[0][k], 3 - mesh.triangles[0][k]);
}

TEST(ObjReader, ReadsNegativeIndicesContinuationsCommentsAndEveryLineEnd) {
  const std::string text =
      "# a comment\r\nv 0 0 0\r\nv 1 0 0 # here too\r\nv 1 1 0\r\nv 0 1 0\r\nf -4 -3 \\\r\n -2 -1 # x";
  EXPECT_EQ(import_text("a.obj", text).polygons.corner_vertices, std::vector<Index>({0, 1, 2, 3}));
  EXPECT_EQ(import_text("a.OBJ", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3").triangles.size(), 1U);
}

TEST(ObjReader, ReadsFacesBeforeTheirVertices) {
  EXPECT_EQ(import_text("a.obj", std::string("f 1 2 3\n") + kSquare).triangles.size(), 1U);
  EXPECT_NE(import_error("a.obj", std::string("f 1 2 5\n") + kSquare).find("a.obj:1:"), std::string::npos);
}

TEST(ObjReader, MakesVertexGroupsOfGroupsObjectsAndMaterials) {
  const SurfaceMesh mesh = import_text(
      "a.obj", std::string("o body\n") + kSquare + "g left all\nf 1 2 3\nusemtl red paint\ng right all\nf 1 3 4\n");
  ASSERT_EQ(mesh.groups.size(), 5U);
  const auto group = [&](const std::string& name) {
    for (const VertexGroup& g : mesh.groups)
      if (g.name == name) return g.vertices;
    return std::vector<Index>{-1};
  };
  EXPECT_EQ(group("left"), std::vector<Index>({0, 1, 2}));
  EXPECT_EQ(group("right"), std::vector<Index>({0, 2, 3}));
  EXPECT_EQ(group("all"), std::vector<Index>({0, 1, 2, 3}));
  EXPECT_EQ(group("body"), std::vector<Index>({0, 1, 2, 3}));
  EXPECT_EQ(group("red paint"), std::vector<Index>({0, 2, 3}));
  EXPECT_EQ(mesh.groups[static_cast<std::size_t>(mesh.polygons.polygon_groups[1])].name, "right");
  ASSERT_EQ(mesh.polygons.polygon_materials.size(), 2U);
  EXPECT_EQ(mesh.polygons.polygon_materials[0], -1);
  EXPECT_EQ(mesh.groups[static_cast<std::size_t>(mesh.polygons.polygon_materials[1])].name, "red paint");
  EXPECT_TRUE(import_text("a.obj", std::string("o body\n") + kSquare + "f 1 2 3\n").polygons.polygon_materials.empty());
}

TEST(ObjReader, SaysWhichLineIsWrongWithWhatAndWhatToDo) {
  const std::string range = import_error("a.obj", std::string(kSquare) + "f 1 2 9\n");
  EXPECT_NE(range.find("a.obj:5: a face refers to vertex 9"), std::string::npos) << range;
  EXPECT_NE(range.find("Accepted: one of the file's 4"), std::string::npos) << range;
  EXPECT_NE(range.find("Export"), std::string::npos) << range;
  EXPECT_NE(import_error("a.obj", std::string(kSquare) + "f 1 2 0\n").find(":5: "), std::string::npos);
  EXPECT_NE(import_error("a.obj", std::string(kSquare) + "f 1 2 -5\n").find("vertex -5"), std::string::npos);
  EXPECT_NE(import_error("a.obj", std::string(kSquare) + "f 1/7 2 3\n").find("texture coordinate 7"),
            std::string::npos);
  EXPECT_NE(import_error("a.obj", std::string(kSquare) + "f 1 2 x\n").find("corner 'x'"), std::string::npos);
  EXPECT_NE(import_error("a.obj", "v 0 0 0\nv 1 0\n").find(":2: a vertex has 2"), std::string::npos);
  EXPECT_NE(import_error("a.obj", "v 0 0 0\nv 1 0 1,5\n").find("coordinate '1,5'"), std::string::npos);
}

TEST(ObjReader, LeavesOutFacesOfTwoCornersWithOneWarning) {
  const testing::TemporaryFolder folder;
  testing::Warnings warnings;
  const std::string path = folder.write("a.obj", std::string(kSquare) + "f 1 2\nf 1 2 3\nf 3\n");
  EXPECT_EQ(import_mesh(path, warnings.log()).polygons.size(), 1U);
  ASSERT_EQ(warnings.lines.size(), 1U);
  EXPECT_NE(warnings.lines[0].find("2 face(s)"), std::string::npos);
  EXPECT_NE(warnings.lines[0].find("a.obj:5"), std::string::npos);
}

}  // namespace
}  // namespace softreel
