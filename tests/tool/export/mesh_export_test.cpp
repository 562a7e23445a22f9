// OBJ and PLY, read back by our own readers: every bit of every position must return.
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/tool/export/format_runs.h"
#include "tool/export/obj_export.h"
#include "tool/export/ply_export.h"

namespace softreel {
namespace {

/// Positions with awkward bits: all exponents, subnormals, negative zero.
std::vector<Vec3> awkward_positions(std::size_t count) {
  std::mt19937_64 random(11);
  std::vector<Vec3> positions(count);
  for (Vec3& p : positions)
    for (int k = 0; k < 3; ++k) {
      p[k] = std::bit_cast<double>(random());
      if (!std::isfinite(p[k])) p[k] = -0.0;
    }
  positions[0] = Vec3(std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max(), -0.0);
  return positions;
}

void expect_same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t v = 0; v < a.size(); ++v)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(std::bit_cast<std::uint64_t>(a[v][k]), std::bit_cast<std::uint64_t>(b[v][k]));
}

SurfaceMesh read_back(const std::string& name, const std::vector<std::uint8_t>& bytes) {
  return testing::import_text(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// Texture coordinate of each corner; (-1, -1) for none.
std::vector<Vec2> corner_textures(const SurfaceMesh& mesh) {
  std::vector<Vec2> values;
  for (const Index t : mesh.polygons.corner_textures)
    values.push_back(t < 0 ? Vec2(-1, -1) : mesh.texture_coordinates[static_cast<std::size_t>(t)]);
  return values;
}

std::map<std::string, std::vector<Index>> groups_of(const SurfaceMesh& mesh) {
  std::map<std::string, std::vector<Index>> groups;
  for (const VertexGroup& group : mesh.groups) groups[group.name] = group.vertices;
  return groups;
}

TEST(ObjExport, ReadsBackBitForBitWithPolygonsTexturesAndGroups) {
  const SurfaceMesh mesh = testing::patchwork();
  const std::vector<Vec3> positions = awkward_positions(mesh.positions.size());
  const SurfaceMesh back = read_back("b.obj", encode_obj(mesh, positions));
  expect_same_bits(back.positions, positions);
  EXPECT_EQ(back.polygons.offsets, mesh.polygons.offsets);
  EXPECT_EQ(back.polygons.corner_vertices, mesh.polygons.corner_vertices);
  EXPECT_EQ(back.polygons.corner_textures, mesh.polygons.corner_textures);
  EXPECT_EQ(back.texture_coordinates, mesh.texture_coordinates);
  EXPECT_EQ(groups_of(back), groups_of(mesh));
  EXPECT_EQ(back.polygons.polygon_groups, mesh.polygons.polygon_groups);
}

/// Quads in a row, in the groups and of the materials that are named; "" for none.
SurfaceMesh strip(const std::vector<std::pair<std::string, std::string>>& faces) {
  std::string text, group, material;
  for (std::size_t k = 0; k <= faces.size(); ++k) text += fmt::format("v {0} 0 0\nv {0} 1 0\n", k);
  for (std::size_t k = 0; k < faces.size(); ++k)
    text += fmt::format("g {}\nusemtl {}\nf {} {} {} {}\n", faces[k].first, faces[k].second, 2 * k + 1, 2 * k + 3,
                        2 * k + 4, 2 * k + 2);
  return read_back("strip.obj", {text.begin(), text.end()});
}

/// "GROUP/MATERIAL ..." of the polygons.
std::string names_of_polygons(const SurfaceMesh& mesh) {
  const auto name = [&](const std::vector<Index>& of, std::size_t p) {
    return of.empty() || of[p] < 0 ? std::string() : mesh.groups[static_cast<std::size_t>(of[p])].name;
  };
  std::string text;
  for (std::size_t p = 0; p < mesh.polygons.size(); ++p)
    text += name(mesh.polygons.polygon_groups, p) + "/" + name(mesh.polygons.polygon_materials, p) + " ";
  return text;
}

TEST(ObjExport, KeepsTheMaterialsOfFacesBesideTheirGroups) {
  for (const auto& [faces, expected] :
       std::vector<std::pair<std::vector<std::pair<std::string, std::string>>, std::string>>{
           {{{"body", "red"}, {"body", "blue"}, {"hat", "blue"}, {"hat", ""}}, "body/red body/blue hat/blue hat/ "},
           {{{"", "red"}, {"", "blue"}, {"", ""}, {"hat", ""}}, "red/red blue/blue / hat/ "}}) {
    const SurfaceMesh mesh = strip(faces), back = read_back("b.obj", encode_obj(mesh, mesh.positions));
    EXPECT_EQ(names_of_polygons(mesh), expected);
    EXPECT_EQ(names_of_polygons(back), expected);
    EXPECT_EQ(groups_of(back), groups_of(mesh));
  }
}

TEST(ObjExport, OfItsOwnResultHasTheSameBytes) {
  const SurfaceMesh mesh = testing::patchwork();
  const std::vector<std::uint8_t> bytes = encode_obj(mesh, mesh.positions);
  const SurfaceMesh back = read_back("b.obj", bytes);
  EXPECT_EQ(encode_obj(back, back.positions), bytes);
}

TEST(ObjExport, KeepsGroupsApartWhoseNamesHaveBlanks) {
  SurfaceMesh mesh = testing::patchwork();
  ASSERT_GE(mesh.groups.size(), 2U);
  mesh.groups[0].name = "left arm";
  mesh.groups[1].name = "left#arm";
  const SurfaceMesh back = read_back("b.obj", encode_obj(mesh, mesh.positions));
  ASSERT_EQ(back.groups.size(), mesh.groups.size());
  EXPECT_EQ(back.groups[0].name, "left_arm");
  EXPECT_EQ(back.groups[1].name, "left_arm_2");
  EXPECT_EQ(back.groups[0].vertices, mesh.groups[0].vertices);
  EXPECT_EQ(back.groups[1].vertices, mesh.groups[1].vertices);
}

TEST(ObjExport, NormalsAreThoseOfTheVerticesThatCornersName) {
  for (const bool textured : {true, false}) {
    SurfaceMesh mesh = textured ? testing::patchwork() : testing::unit_box();
    const std::vector<Vec3> normals = vertex_normals(mesh, mesh.positions);
    const std::vector<std::uint8_t> bytes = encode_obj(mesh, mesh.positions, normals);
    std::istringstream text(std::string(bytes.begin(), bytes.end()));
    std::vector<Vec3> read;
    std::size_t corners = 0;
    for (std::string word, line; std::getline(text, line);) {
      std::istringstream words(line);
      words >> word;
      if (word == "vn") {
        Vec3& n = read.emplace_back();
        words >> n.x() >> n.y() >> n.z();
      }
      if (word != "f") continue;
      for (; words >> word; ++corners) {
        EXPECT_EQ(std::count(word.begin(), word.end(), '/'), 2);
        EXPECT_EQ(word.find("//") == std::string::npos, textured);
        EXPECT_EQ(word.substr(0, word.find('/')), word.substr(word.rfind('/') + 1));
      }
    }
    EXPECT_EQ(corners, mesh.polygons.corner_vertices.size());
    expect_same_bits(read, normals);
    EXPECT_EQ(read_back("b.obj", bytes).polygons.corner_textures, mesh.polygons.corner_textures);
  }
}

TEST(PlyExport, NormalsStandBehindPositionsAndDisturbNothing) {
  const SurfaceMesh mesh = testing::patchwork();
  const std::vector<std::uint8_t> bytes = encode_ply(mesh, mesh.positions, vertex_normals(mesh, mesh.positions));
  const std::string text(bytes.begin(), bytes.end());
  EXPECT_NE(text.find("z\nproperty double nx\nproperty double ny\nproperty double nz\n"), std::string::npos);
  const SurfaceMesh back = read_back("b.ply", bytes);
  expect_same_bits(back.positions, mesh.positions);
  EXPECT_EQ(groups_of(back), groups_of(mesh));
  const std::size_t first = text.find("end_header\n") + 11;
  Vec3 normal;
  std::memcpy(normal.data(), bytes.data() + first + sizeof(Vec3), sizeof(Vec3));
  EXPECT_EQ(normal, vertex_normals(mesh, mesh.positions)[0]);
}

TEST(PlyExport, ReadsBackBitForBitWithTexturesPerCorner) {
  const SurfaceMesh mesh = testing::patchwork();
  const std::vector<Vec3> positions = awkward_positions(mesh.positions.size());
  const SurfaceMesh back = read_back("b.ply", encode_ply(mesh, positions));
  expect_same_bits(back.positions, positions);
  EXPECT_EQ(back.polygons.offsets, mesh.polygons.offsets);
  EXPECT_EQ(back.polygons.corner_vertices, mesh.polygons.corner_vertices);
  EXPECT_EQ(corner_textures(back), corner_textures(mesh));
  EXPECT_EQ(groups_of(back), groups_of(mesh));
}

TEST(PlyExport, KeepsTexturesPerVertexAndNamesWithBlanks) {
  SurfaceMesh mesh = testing::unit_box();
  for (Index v = 0; v < 8; ++v) mesh.texture_coordinates.emplace_back(0.1 * v, 1.0 / (v + 3));
  mesh.polygons.corner_textures = mesh.polygons.corner_vertices;
  mesh.groups = {{"left hand", {0, 5}}, {"100%", {}}};
  const std::vector<std::uint8_t> bytes = encode_ply(mesh, mesh.positions);
  EXPECT_NE(std::string(bytes.begin(), bytes.end()).find("property double s\n"), std::string::npos);
  const SurfaceMesh back = read_back("b.ply", bytes);
  EXPECT_EQ(back.texture_coordinates, mesh.texture_coordinates);
  EXPECT_EQ(back.polygons.corner_textures, mesh.polygons.corner_textures);
  EXPECT_EQ(groups_of(back), groups_of(mesh));
}

TEST(PlyExport, HoldsPolygonsOfMoreThan255Corners) {
  SurfaceMesh mesh;
  for (int i = 0; i < 300; ++i) {
    mesh.positions.emplace_back(std::cos(0.02 * i), std::sin(0.02 * i), 0);
    mesh.polygons.corner_vertices.push_back(i);
  }
  mesh.polygons.offsets.push_back(300);
  const SurfaceMesh back = read_back("b.ply", encode_ply(mesh, mesh.positions));
  EXPECT_EQ(back.polygons.corner_vertices, mesh.polygons.corner_vertices);
  EXPECT_EQ(back.triangles.size(), 298U);
}

std::vector<std::vector<std::uint8_t>> encoded(const SurfaceMesh& mesh) {
  return {encode_obj(mesh, mesh.positions), encode_ply(mesh, mesh.positions)};
}

std::vector<SurfaceMesh> read_back_of_both(const SurfaceMesh& mesh) {
  return {read_back("b.obj", encoded(mesh)[0]), read_back("b.ply", encoded(mesh)[1])};
}

bool has_text(const std::vector<std::uint8_t>& bytes, const std::string& text) {
  return std::string(bytes.begin(), bytes.end()).find(text) != std::string::npos;
}

TEST(MeshExport, ColoursOfBytesReadBackBitForBitBesideAllElse) {
  SurfaceMesh mesh = testing::patchwork();
  testing::paint_with_bytes(mesh);
  EXPECT_TRUE(has_text(encoded(mesh)[1], "property uchar red\n"));
  for (const SurfaceMesh& back : read_back_of_both(mesh)) {
    EXPECT_EQ(back.colors, mesh.colors);
    expect_same_bits(back.positions, mesh.positions);
    EXPECT_EQ(corner_textures(back), corner_textures(mesh));
    EXPECT_EQ(groups_of(back), groups_of(mesh));
  }
}

TEST(MeshExport, ColoursThatAreNoBytesAreNotRoundedToThem) {
  SurfaceMesh mesh = testing::unit_box();
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    mesh.colors.emplace_back(0.12345f, 1e-4f * static_cast<float>(v), 0.98765f);
  EXPECT_TRUE(has_text(encoded(mesh)[1], "property float red\n"));
  for (const SurfaceMesh& back : read_back_of_both(mesh)) {
    ASSERT_EQ(back.colors.size(), mesh.colors.size());
    for (std::size_t v = 0; v < mesh.colors.size(); ++v)
      EXPECT_LE((back.colors[v] - mesh.colors[v]).cwiseAbs().maxCoeff(), 1e-6f) << "vertex " << v;
  }
}

TEST(MeshExport, ColoursThatNoScreenShowsAreHeldInRange) {
  SurfaceMesh mesh = testing::unit_box();
  mesh.colors.assign(mesh.positions.size(), Vec3f(-1, 300, std::numeric_limits<float>::quiet_NaN()));
  for (const SurfaceMesh& back : read_back_of_both(mesh))
    EXPECT_EQ(back.colors, std::vector<Vec3f>(mesh.positions.size(), Vec3f(0, 1, 0)));
}

TEST(MeshExport, OfARealMeshHasTheNumbersOfItsFile) {
  const std::string path = testing::shared_mesh("spot.obj");
  if (path.empty()) GTEST_SKIP() << "shared/meshes/spot.obj is not beside the project";
  const SurfaceMesh mesh = import_mesh(path, Log{});
  for (const SurfaceMesh& back :
       {read_back("b.obj", encode_obj(mesh, mesh.positions)), read_back("b.ply", encode_ply(mesh, mesh.positions))}) {
    expect_same_bits(back.positions, mesh.positions);
    EXPECT_EQ(back.polygons.corner_vertices, mesh.polygons.corner_vertices);
    EXPECT_EQ(corner_textures(back), corner_textures(mesh));
  }
}

}  // namespace
}  // namespace softreel
