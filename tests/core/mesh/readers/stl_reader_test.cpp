#include <cstring>

#include <gtest/gtest.h>

#include "tests/core/mesh/mesh_files.h"

namespace softreel {
namespace {

using testing::import_error;
using testing::import_text;

constexpr const char* kTextStl =
    "solid left part\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 0.5\n"
    "  endloop\n endfacet\nendsolid left part\nsolid\nfacet normal 0 0 1 outer loop vertex 0 0 1 vertex 1 0 1 vertex 0 "
    "1 1 "
    "endloop endfacet\nendsolid";

std::string binary_stl(std::uint32_t announced, std::uint32_t written) {
  std::string bytes(80, ' ');
  std::memcpy(bytes.data(), "solid but binary", 16);  // some programs do that
  bytes.append(reinterpret_cast<const char*>(&announced), 4);
  for (std::uint32_t f = 0; f < written; ++f) {
    const std::array<float, 12> values{0, 0, 1, 0, 0, static_cast<float>(f), 1, 0, 0, 0, 1, 0.1F};
    bytes.append(reinterpret_cast<const char*>(values.data()), sizeof values);
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST(StlReader, ReadsTextWithAGroupPerNamedSolid) {
  const SurfaceMesh mesh = import_text("a.stl", kTextStl);
  ASSERT_EQ(mesh.positions.size(), 6U);
  EXPECT_EQ(mesh.positions[2], Vec3(0, 1, 0.5));
  EXPECT_EQ(mesh.triangles, std::vector<Triangle>({{0, 1, 2}, {3, 4, 5}}));
  ASSERT_EQ(mesh.groups.size(), 1U);
  EXPECT_EQ(mesh.groups[0].name, "left part");
  EXPECT_EQ(mesh.groups[0].vertices, std::vector<Index>({0, 1, 2}));
}

TEST(StlReader, ReadsBinaryThatCallsItselfSolid) {
  const SurfaceMesh mesh = import_text("a.stl", binary_stl(3, 3));
  ASSERT_EQ(mesh.positions.size(), 9U);
  EXPECT_EQ(mesh.positions[6], Vec3(0, 0, 2));
  EXPECT_EQ(mesh.positions[8], Vec3(0, 1, static_cast<double>(0.1F)));
}

TEST(StlReader, ReadsTextInCapitalLetters) {
  const SurfaceMesh mesh = import_text("a.stl",
                                       "SOLID Left\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\n"
                                       "VERTEX 0 1E0 0.5\nENDLOOP\nENDFACET\nENDSOLID Left\n");
  ASSERT_EQ(mesh.positions.size(), 3U);
  EXPECT_EQ(mesh.positions[2], Vec3(0, 1, 0.5));
  ASSERT_EQ(mesh.groups.size(), 1U);
  EXPECT_EQ(mesh.groups[0].name, "Left");
}

TEST(StlReader, WarnsOfBytesBehindTheTriangles) {
  const testing::TemporaryFolder folder;
  for (const char first : {'s', 'b'}) {  // whether the header says "solid" or not
    testing::Warnings warnings;
    std::string bytes = binary_stl(2, 2) + "more";
    bytes[0] = first;
    EXPECT_EQ(import_mesh(folder.write("a.stl", bytes), warnings.log()).triangles.size(), 2U);
    ASSERT_EQ(warnings.lines.size(), 1U);
    EXPECT_NE(warnings.lines[0].find("4 bytes"), std::string::npos);
  }
}

TEST(StlReader, RefusesWhatIsCutOff) {
  EXPECT_NE(import_error("a.stl", binary_stl(3, 2)).find("binary file of 234 bytes"), std::string::npos);
  EXPECT_NE(import_error("a.stl", std::string("xyz") + binary_stl(3, 2).substr(3)).find("234"), std::string::npos);
  const std::string text = kTextStl;
  EXPECT_NE(import_error("a.stl", text.substr(0, 80)).find("inside a facet"), std::string::npos);
  EXPECT_NE(import_error("a.stl", "solid x\nfacet normal 0 0 1\nvertex 0 zero 0\n").find(":3: "), std::string::npos);
  EXPECT_NE(import_error("a.stl", "solid x\nfacet\nvertex 0 0 0\nendfacet\n").find("1 corner"), std::string::npos);
  EXPECT_NE(import_error("a.stl", "solid x\nendsolid\n").find("no face"), std::string::npos);
  EXPECT_NE(import_error("a.stl", "not a mesh").find("10 bytes"), std::string::npos);
}

}  // namespace
}  // namespace softreel
