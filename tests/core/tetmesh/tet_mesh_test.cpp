#include "core/tetmesh/tet_mesh.h"

#include <cmath>
#include <cstring>
#include <numbers>
#include <sstream>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/tetmesh/files/tet_mesh_file.h"
#include "core/tetmesh/quality/tet_quality.h"

namespace softreel {
namespace {

TetMesh unit_corner() {
  return {{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}, {{0, 1, 2, 3}}, {}};
}

/// Two tetrahedra on one face, and a third that shares only an edge.
TetMesh three_tets() {
  TetMesh mesh = unit_corner();
  mesh.nodes.insert(mesh.nodes.end(), {Vec3(1, 1, 1), Vec3(-1, -1, 0), Vec3(-1, -1, 1)});
  mesh.tets.push_back({1, 2, 3, 4});
  mesh.tets.push_back({0, 5, 6, 3});
  return mesh;
}

TEST(FindBoundary, FacesPointOutwards) {
  const TetMesh mesh = three_tets();
  const Vec3 first_center(0.25, 0.25, 0.25);
  for (const BoundaryFace& face : find_boundary(unit_corner())) {
    const auto& [a, b, c] = face.nodes;
    const auto x = [&](Index i) { return mesh.nodes[static_cast<std::size_t>(i)]; };
    EXPECT_GT((x(b) - x(a)).cross(x(c) - x(a)).dot(x(a) - first_center), 0);
  }
  EXPECT_EQ(find_boundary(unit_corner()).size(), 4U);
  EXPECT_EQ(find_boundary(mesh).size(), 10U);  // 3 x 4 less the shared face, twice
}

TEST(FaceConnectedPieces, AnEdgeDoesNotJoin) {
  EXPECT_EQ(face_connected_pieces(three_tets()), (std::vector<Index>{0, 0, 1}));
}

TEST(TetVolume, IsPositiveForTheProjectsOrientation) {
  EXPECT_DOUBLE_EQ(tet_volume(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)), 1.0 / 6.0);
}

TEST(DihedralRange, KnowsTheRegularAndTheCornerTetrahedron) {
  const DihedralRange regular = dihedral_range({1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1});
  EXPECT_NEAR(regular.min, std::acos(1.0 / 3.0), 1e-12);
  EXPECT_NEAR(regular.max, std::acos(1.0 / 3.0), 1e-12);
  const DihedralRange corner = dihedral_range({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  EXPECT_NEAR(corner.max, std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(corner.min, std::acos(1.0 / std::sqrt(3.0)), 1e-12);
}

TEST(MeasureQuality, NamesTheWorstElements) {
  TetMesh mesh = unit_corner();
  mesh.nodes.emplace_back(0.3, 0.3, 0.5);
  mesh.tets.push_back({1, 2, 3, 4});
  const TetQuality quality = measure_quality(mesh, Threads(1));
  EXPECT_EQ(quality.min_volume_tet, 1);
  EXPECT_EQ(quality.min_dihedral_tet, 1);
  EXPECT_NEAR(quality.volume, 1.0 / 6.0 + quality.min_volume, 1e-15);
}

TEST(MeasureQuality, DoesNotHideAnElementWithoutVolume) {
  TetMesh mesh = unit_corner();
  mesh.nodes.emplace_back(0.25, 0.25, 0.0);
  mesh.tets.push_back({0, 1, 2, 4});
  const TetQuality quality = measure_quality(mesh, Threads(1));
  EXPECT_EQ(quality.min_volume, 0);
  EXPECT_FALSE(quality.min_dihedral >= 10.0 && quality.max_dihedral <= 165.0);
}

TEST(MeasureDeviation, FindsAShiftedFace) {
  SurfaceMesh surface;
  const TetMesh mesh = unit_corner();
  surface.positions = mesh.nodes;
  surface.triangles = boundary_faces(mesh);
  EXPECT_LT(measure_deviation(surface, mesh, Threads(1)).two_way(), 1e-15);
  surface.positions[3] += Vec3(0, 0, 0.5);
  EXPECT_NEAR(measure_deviation(surface, mesh, Threads(1)).from_surface, 0.5, 1e-12);
}

std::string text_of(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

TEST(EncodeTetMesh, GmshTextReadsBackExactly) {
  TetMesh mesh = three_tets();
  mesh.nodes[3] = Vec3(0.1, 1.0 / 3.0, 1e-300);
  std::istringstream in(text_of(encode_tet_mesh(mesh, ".msh")));
  std::string word;
  while (word != "$Nodes") in >> word;
  std::size_t count = 0;
  in >> count;
  ASSERT_EQ(count, mesh.nodes.size());
  for (const Vec3& expected : mesh.nodes) {
    std::string number, x, y, z;
    in >> number >> x >> y >> z;
    EXPECT_EQ(Vec3(std::stod(x), std::stod(y), std::strtod(z.c_str(), nullptr)), expected);
  }
  in >> word >> word >> count;
  ASSERT_EQ(count, mesh.tets.size());
  for (const Tet& expected : mesh.tets) {
    int number = 0, type = 0, tags = 0, tag = 0;
    Tet tet;
    in >> number >> type >> tags >> tag >> tag >> tet[0] >> tet[1] >> tet[2] >> tet[3];
    for (Index& node : tet) --node;
    EXPECT_EQ(type, 4);
    EXPECT_EQ(tet, expected);
  }
}

TEST(EncodeTetMesh, VtuBlocksLieWhereItsHeaderSays) {
  const TetMesh mesh = three_tets();
  const std::vector<std::uint8_t> bytes = encode_tet_mesh(mesh, ".vtu");
  const std::string text = text_of(bytes);
  const std::size_t data = text.find("\n_") + 2;
  const auto offset_of = [&](const std::string& name) {
    const std::size_t at = text.find("offset=\"", text.find(name));
    return data + static_cast<std::size_t>(std::stoul(text.substr(at + 8)));
  };
  const auto size_at = [&](std::size_t at) {
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data() + at, sizeof(size));
    return size;
  };
  EXPECT_EQ(size_at(offset_of("<Points>")), mesh.nodes.size() * 24);
  EXPECT_EQ(size_at(offset_of("\"connectivity\"")), mesh.tets.size() * 16);
  EXPECT_EQ(size_at(offset_of("\"offsets\"")), mesh.tets.size() * 8);
  EXPECT_EQ(size_at(offset_of("\"types\"")), mesh.tets.size());
  Tet last;
  std::memcpy(&last, bytes.data() + offset_of("\"connectivity\"") + 8 + 32, sizeof(last));
  EXPECT_EQ(last, mesh.tets.back());
}

TEST(EncodeTetMesh, VtuHoldsFillsAsCellData) {
  TetMesh mesh = three_tets();
  const std::string whole = text_of(encode_tet_mesh(mesh, ".vtu"));
  EXPECT_EQ(whole.find("CellData"), std::string::npos);
  mesh.fill = {1, 0.25, 1e-6};
  const std::string text = text_of(encode_tet_mesh(mesh, ".vtu"));
  const std::size_t at = text.find("Name=\"fill\"");
  ASSERT_NE(at, std::string::npos);
  EXPECT_GT(at, text.find("<CellData"));
  const auto offset = static_cast<std::size_t>(std::stoul(text.substr(text.find("offset=\"", at) + 8)));
  std::vector<double> fill(3);
  std::memcpy(fill.data(), text.data() + text.find("\n_") + 2 + offset + sizeof(std::uint64_t), 24);
  EXPECT_EQ(fill, mesh.fill);
  TetMesh corner = unit_corner();
  corner.fill = {0.5};
  const TetMesh read = decode_tet_mesh("a.vtu", text_of(encode_tet_mesh(corner, ".vtu")), ".vtu", {});
  EXPECT_EQ(read.tets, corner.tets);
  EXPECT_EQ(read.fill, corner.fill);
  for (const double wrong : {0.0, -0.5, 1.5}) {
    corner.fill = {wrong};
    EXPECT_THROW(decode_tet_mesh("a.vtu", text_of(encode_tet_mesh(corner, ".vtu")), ".vtu", {}), Error) << wrong;
  }
}

TEST(EncodeTetMesh, MeditListsNodesBoundaryAndElements) {
  const std::string text = text_of(encode_tet_mesh(three_tets(), ".mesh"));
  EXPECT_NE(text.find("Vertices\n7\n"), std::string::npos);
  EXPECT_NE(text.find("Triangles\n10\n"), std::string::npos);
  EXPECT_NE(text.find("Tetrahedra\n3\n1 2 3 4 0\n"), std::string::npos);
}

TEST(EncodeTetMesh, SaysThatMeditHasNoPlaceForFills) {
  TetMesh mesh = unit_corner();
  std::vector<std::string> warnings;
  const Log log{nullptr, [&](const std::string& line) { warnings.push_back(line); }};
  encode_tet_mesh(mesh, ".mesh", log);
  mesh.fill = {0.5};
  encode_tet_mesh(mesh, ".msh", log);
  EXPECT_TRUE(warnings.empty());
  encode_tet_mesh(mesh, ".mesh", log);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find(".vtu"), std::string::npos);
}

TEST(EncodeTetMesh, RefusesOtherFormatsAndNamesItsOwn) {
  try {
    encode_tet_mesh(unit_corner(), ".stl");
    FAIL();
  } catch (const Error& error) {
    for (const char* part : {"'.stl'", "Accepted", ".vtu", ".msh", ".mesh"})
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos);
  }
}

}  // namespace
}  // namespace softreel
