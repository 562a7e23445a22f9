#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>

#include "core/mesh/readers/ply_header.h"
#include "tests/core/mesh/mesh_files.h"

namespace softreel {
namespace {

using testing::import_error;
using testing::import_text;

constexpr const char* kTextPly =
    "ply\nformat ascii 1.0\ncomment a square\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty float s\nproperty float t\nproperty uchar group_hand\nproperty float "
    "group_left%20arm\n"
    "element face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\nend_header\n"
    "0.1 0 0 255 0 0 1 0\n1 0 0 255 1 0 0 0.5\n1 1 0 255 1 1 0 0\n0 1 0 255 0 1 1 1\n9 9 9 255 0.5 0.5 0 0\n"
    "0 4 0 1 2 3\n0 3 0 1 2\n";

TEST(PlyReader, ReadsTextWithGroupsAndTextureCoordinates) {
  const SurfaceMesh mesh = import_text("a.ply", kTextPly);
  ASSERT_EQ(mesh.positions.size(), 5U);
  EXPECT_EQ(mesh.positions[0].x(), 0.1);  // not the float nearest to it
  EXPECT_EQ(mesh.polygons.offsets, std::vector<Index>({0, 4, 7}));
  EXPECT_EQ(mesh.polygons.corner_textures, mesh.polygons.corner_vertices);
  EXPECT_EQ(mesh.texture_coordinates[4], Vec2(0.5, 0.5));
  ASSERT_EQ(mesh.groups.size(), 2U);
  EXPECT_EQ(mesh.groups[0].name, "hand");
  EXPECT_EQ(mesh.groups[0].vertices, std::vector<Index>({0, 3}));
  EXPECT_EQ(mesh.groups[1].name, "left arm");
  EXPECT_EQ(mesh.groups[1].vertices, std::vector<Index>({1, 3}));
}

TEST(PlyReader, TakesCarriageReturnsAndNoLastLineEnd) {
  std::string text = kTextPly, crlf;
  text.pop_back();
  for (const char c : text) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(import_text("a.ply", crlf).positions, import_text("a.ply", kTextPly).positions);
}

/// A binary file written value by value in either byte order.
class BinaryPly {
 public:
  BinaryPly(bool big_endian, const std::string& elements)
      : big_endian_(big_endian),
        bytes_("ply\nformat binary_" + std::string(big_endian ? "big" : "little") + "_endian 1.0\n" + elements +
               "end_header\n") {}

  template <typename T>
  void put(T value) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if (big_endian_) std::reverse(raw.begin(), raw.end());
    bytes_.append(raw.data(), raw.size());
  }
  const std::string& bytes() const { return bytes_; }

 private:
  bool big_endian_;
  std::string bytes_;
};

std::string binary_tetrahedron(bool big_endian) {
  BinaryPly ply(
      big_endian,
      "element face 4\nproperty list uchar ushort vertex_index\nproperty short group\n"
      "element vertex 4\nproperty double x\nproperty float y\nproperty int z\nproperty list char float extra\n");
  for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{0, 3, 2}}) {
    ply.put(std::uint8_t{3});
    for (const Index v : t) ply.put(static_cast<std::uint16_t>(v));
    ply.put(static_cast<std::int16_t>(t[0] + 6));
  }
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0, 0.5, 0), Vec3(0, 0, 300)}) {
    ply.put(p.x());
    ply.put(static_cast<float>(p.y()));
    ply.put(static_cast<std::int32_t>(p.z()));
    ply.put(std::int8_t{2});
    ply.put(1.5F);
    ply.put(2.5F);
  }
  return ply.bytes();
}

TEST(PlyReader, ReadsBothByteOrdersAndFacesBeforeVertices) {
  for (const bool big_endian : {false, true}) {
    const SurfaceMesh mesh = import_text("a.ply", binary_tetrahedron(big_endian));
    ASSERT_EQ(mesh.positions.size(), 4U);
    EXPECT_EQ(mesh.positions[1], Vec3(0.1, 0, 0));
    EXPECT_EQ(mesh.positions[2], Vec3(0, 0.5, 0));
    EXPECT_EQ(mesh.positions[3], Vec3(0, 0, 300));
    EXPECT_EQ(mesh.triangles[2], (Triangle{1, 2, 3}));
    ASSERT_EQ(mesh.groups.size(), 2U);
    EXPECT_EQ(mesh.groups[1].name, "7");
    EXPECT_EQ(mesh.groups[1].vertices, std::vector<Index>({1, 2, 3}));
    EXPECT_EQ(mesh.polygons.polygon_groups, std::vector<Index>({0, 0, 1, 0}));
  }
}

TEST(PlyReader, RefusesEveryTruncationOfABinaryFile) {
  const std::string whole = binary_tetrahedron(false);
  for (std::size_t size = 1; size < whole.size(); ++size)
    EXPECT_FALSE(import_error("a.ply", whole.substr(0, size)).empty()) << size;
}

TEST(PlyReader, ReadsStripsAndTextureCoordinatesPerCorner) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n";
  const SurfaceMesh strips =
      import_text("a.ply", header + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                               vertices + "8 0 1 2 3 -1 1 4 3\n");
  EXPECT_EQ(strips.triangles, std::vector<Triangle>({{0, 1, 2}, {1, 3, 2}, {1, 4, 3}}));
  const SurfaceMesh corners = import_text(
      "a.ply", header +
                   "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
                   "end_header\n" +
                   vertices + "3 0 1 2 6 0 0 1 0 0 1\n3 1 3 2 0\n");
  EXPECT_EQ(corners.polygons.corner_textures, std::vector<Index>({0, 1, 2, -1, -1, -1}));
  EXPECT_EQ(corners.texture_coordinates[1], Vec2(1, 0));
}

TEST(PlyReader, SaysWhereAFileIsWrong) {
  const std::string text = kTextPly;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    return import_error("a.ply", changed.replace(changed.find(from), from.size(), to));
  };
  EXPECT_NE(with("3 0 1 2", "3 0 1 5").find("vertex 5"), std::string::npos);
  EXPECT_NE(with("3 0 1 2", "3 0 1 5").find("a.ply:23:"), std::string::npos);
  EXPECT_NE(with("3 0 1 2", "3 0 1 -2").find("vertex -2"), std::string::npos);
  EXPECT_NE(with("3 0 1 2", "3 0 1 1.5").find("vertex 1.5"), std::string::npos);
  EXPECT_NE(with("1 0 0 255", "1 O 0 255").find("a.ply:17: 'O' is not a number"), std::string::npos);
  EXPECT_NE(with("vertex 5", "vertex 2000000000").find("cut off"), std::string::npos);
  EXPECT_NE(with("vertex 5", "vertex -5").find("a.ply:4:"), std::string::npos);
  EXPECT_NE(with("ascii", "gzip").find("'gzip'"), std::string::npos);
  EXPECT_NE(with("float x", "real x").find("'real'"), std::string::npos);
  EXPECT_NE(with("float z", "float w").find("x, y and z"), std::string::npos);
  EXPECT_NE(with("end_header", "the_end").find("'the_end'"), std::string::npos);
  EXPECT_NE(with("ply", "pyl").find("first line"), std::string::npos);
  EXPECT_NE(with("0 4 0 1 2 3\n0 3 0 1 2\n", "0 4 0 1").find("ends before"), std::string::npos);
}

TEST(PlyName, IsRestoredFromItsCode) {
  for (const std::string name : {"hand", "left arm", "50%", "%20", "tab\there", "\xC3\xA9"}) {
    const std::string code = detail::encode_ply_name(name);
    EXPECT_EQ(code.find_first_of(" \t\n"), std::string::npos);
    EXPECT_EQ(detail::decode_ply_name(code), name);
  }
}

TEST(PlyReader, ReadsColoursOfVerticesInBytesAndInFloats) {
  const auto text = [](const char* type, const char* full) {
    return std::string(
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n") +
           "property " + type + " red\nproperty " + type + " green\nproperty " + type +
           " blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 0\n1 0 0 " + full +
           " 0 0\n0 1 0 0 0 " + full + "\n3 0 1 2\n";
  };
  for (const SurfaceMesh& mesh :
       {import_text("a.ply", text("uchar", "255")), import_text("b.ply", text("float", "1"))}) {
    ASSERT_EQ(mesh.colors.size(), 3U);
    EXPECT_EQ(mesh.colors[0], Vec3f(0, 0, 0));
    EXPECT_EQ(mesh.colors[1], Vec3f(1, 0, 0));
    EXPECT_EQ(mesh.colors[2], Vec3f(0, 0, 1));
  }
}

}  // namespace
}  // namespace softreel
