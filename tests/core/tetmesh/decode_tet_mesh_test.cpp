#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/tetmesh/files/tet_mesh_file.h"
#include "core/tetmesh/quality/tet_quality.h"

namespace softreel {
namespace {

/// Two tetrahedra that share a face.
TetMesh two_tets() {
  TetMesh mesh;
  mesh.nodes = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.1, 0.2, 1.0 / 3), Vec3(1, 1, 1.5)};
  mesh.tets = {{0, 1, 2, 3}, {1, 4, 2, 3}};
  return mesh;
}

struct Decoded {
  TetMesh mesh;
  std::vector<std::string> lines;
};

Decoded decode(const std::string& bytes, const std::string& extension) {
  Decoded decoded;
  const auto collect = [&](const std::string& line) { decoded.lines.push_back(line); };
  decoded.mesh = decode_tet_mesh("given" + extension, bytes, extension, {collect, collect});
  return decoded;
}

void expect_two_tets(const std::string& bytes, const std::string& extension) {
  const Decoded decoded = decode(bytes, extension);
  EXPECT_EQ(decoded.mesh.nodes, two_tets().nodes);
  EXPECT_EQ(decoded.mesh.tets, two_tets().tets);
  EXPECT_EQ(decoded.mesh.lattice.spacing, 0);
  EXPECT_TRUE(decoded.lines.empty()) << decoded.lines.front();
}

/// The message of the error that the file causes, which must be of kind Input.
std::string failure(const std::string& bytes, const std::string& extension) {
  try {
    decode(bytes, extension);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    EXPECT_NE(std::string(error.what()).find("Accepted: "), std::string::npos) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "was read:\n" << bytes;
  return {};
}

std::string encoded(const TetMesh& mesh, const std::string& extension) {
  const std::vector<std::uint8_t> bytes = encode_tet_mesh(mesh, extension);
  return {bytes.begin(), bytes.end()};
}

template <typename... T>
std::string raw(const T&... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
  return bytes;
}

template <typename T>
std::string big_endian(T value) {
  std::string bytes = raw(value);
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text.push_back(i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63]);
  }
  return text;
}

std::string gmsh2_binary() {
  const TetMesh mesh = two_tets();
  std::string text = "$MeshFormat\n2.2 1 8\n" + raw(std::int32_t{1}) + "\n$EndMeshFormat\n$Nodes\n5\n";
  for (std::int32_t i = 0; i < 5; ++i) {
    const Vec3& p = mesh.nodes[static_cast<std::size_t>(i)];
    text += raw(std::int32_t{10 + i}, p[0], p[1], p[2]);
  }
  text += "\n$EndNodes\n$Elements\n3\n";
  text += raw(std::int32_t{2}, std::int32_t{1}, std::int32_t{2}, std::int32_t{1}, std::int32_t{0}, std::int32_t{0},
              std::int32_t{10}, std::int32_t{11}, std::int32_t{12});  // a triangle
  text += raw(std::int32_t{4}, std::int32_t{2}, std::int32_t{1});
  for (std::int32_t e = 0; e < 2; ++e) {
    text += raw(std::int32_t{e + 2}, std::int32_t{7});
    for (const Index node : mesh.tets[static_cast<std::size_t>(e)]) text += raw(std::int32_t{10 + node});
  }
  return text + "\n$EndElements\n";
}

std::string gmsh4(bool binary) {
  const TetMesh mesh = two_tets();
  const auto size = [&](std::uint64_t v) { return binary ? raw(v) : fmt::format("{} ", v); };
  const auto number = [&](std::int32_t v) { return binary ? raw(v) : fmt::format("{} ", v); };
  const auto real = [&](double v) { return binary ? raw(v) : fmt::format("{} ", v); };
  std::string text = fmt::format("$MeshFormat\n4.1 {} 8\n", binary ? 1 : 0);
  if (binary) text += raw(std::int32_t{1}) + "\n";
  text += "$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n$Nodes\n";
  text += size(2) + size(5) + size(100) + size(104);
  for (const auto& [first, last] : {std::pair<std::uint64_t, std::uint64_t>{0, 2}, {2, 5}}) {
    text += number(3) + number(1) + number(0) + size(last - first);
    for (std::uint64_t i = first; i < last; ++i) text += size(100 + i);
    for (std::uint64_t i = first; i < last; ++i)
      for (int k = 0; k < 3; ++k) text += real(mesh.nodes[i][k]);
  }
  text += "\n$EndNodes\n$Elements\n" + size(2) + size(3) + size(1) + size(3);
  text += number(2) + number(1) + number(2) + size(1) + size(1) + size(100) + size(101) + size(102);
  text += number(3) + number(1) + number(4) + size(2);
  for (std::uint64_t e = 0; e < 2; ++e) {
    text += size(e + 2);
    for (const Index node : mesh.tets[e]) text += size(100 + static_cast<std::uint64_t>(node));
  }
  return text + "\n$EndElements\n";
}

std::string vtk(bool binary, bool with_offsets) {
  const TetMesh mesh = two_tets();
  const auto real = [&](double v) { return binary ? big_endian(v) : fmt::format("{} ", v); };
  const auto number = [&](std::int32_t v) { return binary ? big_endian(v) : fmt::format("{} ", v); };
  const auto wide = [&](std::int64_t v) { return binary ? big_endian(v) : fmt::format("{} ", v); };
  std::string text = fmt::format("# vtk DataFile Version {}\ntwo tetrahedra\n{}\nDATASET UNSTRUCTURED_GRID\n",
                                 with_offsets ? "5.1" : "3.0", binary ? "BINARY" : "ASCII");
  text += "FIELD FieldData 2\nTIME 1 1 double\n" + real(0.5) + "\nMETADATA\nINFORMATION 0\n\nCYCLE 2 1 int\n" +
          number(3) + number(4) + "\n";
  text += "POINTS 5 double\n";
  for (const Vec3& p : mesh.nodes)
    for (int k = 0; k < 3; ++k) text += real(p[k]);
  text += "\nMETADATA\nINFORMATION 0\n\n";
  if (with_offsets) {
    text += "CELLS 3 8\nOFFSETS vtktypeint64\n" + wide(0) + wide(4) + wide(8) + "\nCONNECTIVITY vtktypeint64\n";
    for (const Tet& tet : mesh.tets)
      for (const Index node : tet) text += wide(node);
  } else {
    text += "CELLS 3 14\n" + number(3) + number(0) + number(1) + number(2);
    for (const Tet& tet : mesh.tets) {
      text += number(4);
      for (const Index node : tet) text += number(node);
    }
  }
  text += with_offsets ? "\nCELL_TYPES 2\n" : "\nCELL_TYPES 3\n" + number(5);
  return text + number(10) + number(10) + "\nPOINT_DATA 5\nSCALARS anything float\n";
}

/// format: "ascii" or "binary" (base64).
std::string vtu(const std::string& format) {
  const TetMesh mesh = two_tets();
  const bool text = format == "ascii";
  const auto array = [&](const std::string& name, const std::string& type, const auto& values) {
    std::string data;
    for (const auto value : values) data += text ? fmt::format("{} ", value) : raw(value);
    if (!text) data = base64(raw(static_cast<std::uint32_t>(data.size())) + data);
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"3\" format=\"{}\">\n{}\n</DataArray>\n",
                       type, name, format, data);
  };
  std::vector<double> points;
  for (const Vec3& p : mesh.nodes) points.insert(points.end(), {p[0], p[1], p[2]});
  std::vector<std::int64_t> nodes;
  for (const Tet& tet : mesh.tets) nodes.insert(nodes.end(), tet.begin(), tet.end());
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
         "<UnstructuredGrid>\n<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n<Points>\n" +
         array("Points", "Float64", points) + "</Points>\n<Cells>\n" + array("connectivity", "Int64", nodes) +
         array("offsets", "Int64", std::vector<std::int64_t>{4, 8}) +
         array("types", "Int32", std::vector<std::int32_t>{10, 10}) +
         "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

std::string medit(const std::string& vertices, const std::string& tets) {
  return "MeshVersionFormatted 2\nDimension 3\n# a comment\nVertices\n" + vertices +
         "Triangles\n1\n1 2 3 0\nTetrahedra\n" + tets + "End\n";
}

constexpr const char* kFourVertices = "4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n";

TEST(DecodeTetMesh, ReadsBackWhatIsWritten) {
  for (const char* extension : {".vtu", ".msh", ".mesh"}) expect_two_tets(encoded(two_tets(), extension), extension);
}

TEST(DecodeTetMesh, ReadsAllVariantsOfGmsh) {
  expect_two_tets(gmsh2_binary(), ".msh");
  expect_two_tets(gmsh4(false), ".msh");
  expect_two_tets(gmsh4(true), ".msh");
}

TEST(DecodeTetMesh, ReadsAllVariantsOfVtk) {
  for (const bool binary : {false, true})
    for (const bool with_offsets : {false, true}) expect_two_tets(vtk(binary, with_offsets), ".vtk");
  expect_two_tets(vtu("ascii"), ".vtu");
  expect_two_tets(vtu("binary"), ".vtu");
}

TEST(DecodeTetMesh, ReadsVtuWithAttributesInSingleQuotesAndBlanksAboutTheirSigns) {
  std::string text = vtu("ascii");
  std::replace(text.begin(), text.end(), '"', '\'');
  expect_two_tets(text, ".vtu");
  const std::string end = "</Cells>\n";
  text.insert(text.find(end) + end.size(),
              "<CellData>\n<DataArray type='Float64'\nName = 'fill' format='ascii'>0.5 1</DataArray>\n</CellData>\n");
  EXPECT_EQ(decode(text, ".vtu").mesh.fill, (std::vector<double>{0.5, 1}));
}

TEST(DecodeTetMesh, ReadsTheFillOfGmshFiles) {
  TetMesh mesh = two_tets();
  mesh.fill = {0.25, 1};
  EXPECT_EQ(decode(encoded(mesh, ".msh"), ".msh").mesh.fill, mesh.fill);
  const std::string head = "$ElementData\n1\n\"fill\"\n1\n0\n3\n0\n1\n2\n", end = "\n$EndElementData\n";
  const std::string binary = raw(std::int32_t{3}, 1.0) + raw(std::int32_t{2}, 0.25);
  for (const std::string& file : {gmsh2_binary(), gmsh4(true)})
    EXPECT_EQ(decode(file + head + binary + end, ".msh").mesh.fill, mesh.fill);
  std::string other = encoded(mesh, ".msh");
  other.replace(other.find("\"fill\""), 6, "\"heat\"");
  EXPECT_TRUE(decode(other, ".msh").mesh.fill.empty());
}

TEST(DecodeTetMesh, TakesTextBehindAByteOrderMark) {
  for (const char* extension : {".vtu", ".msh", ".mesh"})
    expect_two_tets("\xef\xbb\xbf" + encoded(two_tets(), extension), extension);
}

TEST(DecodeTetMesh, SkipsCommentsAndEmptySectionsOfMedit) {
  const std::string bytes = encoded(two_tets(), ".mesh");
  const std::size_t vertices = bytes.find("Vertices"), second = bytes.find('\n', bytes.find('\n', vertices) + 1) + 1;
  std::string changed = bytes.substr(0, second) + "# between two\n" + bytes.substr(second);
  changed.insert(vertices, "Hexahedra # none\n0\n");
  expect_two_tets("# by hand\n" + changed, ".mesh");
}

TEST(DecodeTetMesh, TakesSectionsOfGmshInAnyOrder) {
  for (const std::string& bytes : {gmsh2_binary(), gmsh4(false), gmsh4(true)}) {
    const std::size_t nodes = bytes.find("$Nodes"), elements = bytes.find("$Elements");
    expect_two_tets("$Comments\n$MeshFormat\n$EndComments\n" + bytes.substr(0, nodes) + bytes.substr(elements) +
                        bytes.substr(nodes, elements - nodes),
                    ".msh");
  }
}

TEST(DecodeTetMesh, TakesWordsOfVtkInLettersOfEitherSize) {
  for (const bool with_offsets : {false, true}) {
    std::string bytes = vtk(false, with_offsets);
    const std::size_t words = bytes.find("ASCII");
    for (std::size_t i = words; i < bytes.size(); ++i) {
      const auto c = static_cast<unsigned char>(bytes[i]);
      bytes[i] = static_cast<char>(std::isupper(c) != 0 ? std::tolower(c) : std::toupper(c));
    }
    expect_two_tets(bytes, ".vtk");
  }
}

TEST(DecodeTetMesh, TurnsInvertedElementsRoundAndLeavesOutUnusedNodes) {
  TetMesh mesh = two_tets();
  std::swap(mesh.tets[1][0], mesh.tets[1][1]);
  mesh.nodes.insert(mesh.nodes.begin(), Vec3(1e9, 0, 0));
  for (Tet& tet : mesh.tets)
    for (Index& node : tet) ++node;
  const Decoded decoded = decode(encoded(mesh, ".msh"), ".msh");
  EXPECT_EQ(decoded.mesh.nodes, two_tets().nodes);
  EXPECT_GT(measure_quality(decoded.mesh, Threads(1)).min_volume, 0);
  ASSERT_EQ(decoded.lines.size(), 2U);
  EXPECT_NE(decoded.lines[0].find("1 inverted"), std::string::npos);
  EXPECT_NE(decoded.lines[1].find("1 nodes that no tetrahedron uses"), std::string::npos);
}

TEST(DecodeTetMesh, LeavesOutWhatItHasTwice) {
  TetMesh mesh = two_tets();
  mesh.tets.push_back({2, 0, 1, 3});  // the first again, in another order
  const Decoded decoded = decode(encoded(mesh, ".mesh"), ".mesh");
  EXPECT_EQ(decoded.mesh.tets, two_tets().tets);
  ASSERT_EQ(decoded.lines.size(), 1U);
  EXPECT_NE(decoded.lines[0].find("1 tetrahedra that it has twice"), std::string::npos) << decoded.lines[0];
}

TEST(DecodeTetMesh, SaysThatPiecesTouchWithoutSharedNodes) {
  const std::string nodes =
      "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0.1 0.2 0.3 0\n"
      "1 0 0 0\n1 1 1.5 0\n0 1 0 0\n0.1 0.2 0.3 0\nTetrahedra\n2\n1 2 3 4 0\n";
  const Decoded parted = decode(nodes + "5 6 7 8 0\nEnd\n", ".mesh");
  ASSERT_EQ(parted.lines.size(), 1U);
  EXPECT_NE(parted.lines[0].find("2 pieces, which come apart although they touch at 1 faces"), std::string::npos)
      << parted.lines[0];
  for (const std::string& line : decode(nodes + "2 6 3 4 0\nEnd\n", ".mesh").lines)
    EXPECT_EQ(line.find("pieces"), std::string::npos) << line;
  const std::string apart =
      "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0.1 0.2 0.3 0\n"
      "5 0 0 0\n6 0 0 0\n5 1 0 0\n5.1 0.2 0.3 0\nTetrahedra\n2\n1 2 3 4 0\n5 6 7 8 0\nEnd\n";
  EXPECT_TRUE(decode(apart, ".mesh").lines.empty()) << "two bodies";
}

TEST(DecodeTetMesh, RefusesTetrahedraThatOverlapAtAFace) {
  TetMesh three = two_tets();  // a third one at the face that the two share
  three.nodes.emplace_back(2, 2, 2);
  three.tets.push_back({1, 5, 2, 3});
  EXPECT_NE(failure(encoded(three, ".mesh"), ".mesh").find("tetrahedra 2 and 3 overlap"), std::string::npos);
  TetMesh same_side = two_tets();
  same_side.tets[1] = {0, 1, 2, 4};  // above the face z = 0, as the first is
  EXPECT_NE(failure(encoded(same_side, ".mesh"), ".mesh").find("tetrahedra 1 and 2 overlap"), std::string::npos);
}

/// Where limbs lie side by side in one lattice tetrahedron, embedded meshes have it twice, with a common face.
TEST(DecodeTetMesh, ReadsCopiesOfOneLatticeTetrahedron) {
  TetMesh mesh = two_tets();
  mesh.nodes.push_back(mesh.nodes[4]);
  mesh.tets.push_back({1, 5, 2, 3});
  EXPECT_EQ(decode(encoded(mesh, ".mesh"), ".mesh").mesh.tets, mesh.tets);
}

TEST(DecodeTetMesh, NamesWhatIsWrong) {
  struct Case {
    std::string bytes;
    const char *extension, *named;
  };
  const Case cases[] = {
      {medit(kFourVertices, "1\n1 2 3 5 0\n"), ".mesh", "tetrahedron 1 refers to node 4"},
      {medit(kFourVertices, "1\n1 2 3 0 0\n"), ".mesh", "refers to node -1"},
      {medit(kFourVertices, "1\n1 2 3 3 0\n"), ".mesh", "tetrahedron 1 has no volume"},
      {medit(kFourVertices, "0\n"), ".mesh", "no tetrahedra"},
      {medit(kFourVertices, "9999999\n1 2 3 4 0\n"), ".mesh", "ends before"},
      {medit(kFourVertices, "1\n1 2 x 4 0\n"), ".mesh", "'x' is no whole number"},
      {medit("1\n0 nan 0 0\n", "1\n1 1 1 1 0\n"), ".mesh", "not finite"},
      {"MeshVersionFormatted 2\nDimension 3\nHexahedra\n1\n", ".mesh", "Hexahedra"},
      {"MeshVersionFormatted 2\nDimension 3\nHexahedra\n", ".mesh", "Hexahedra"},
      {medit(kFourVertices, "1\n1 2 3 4 0\nTetrahedra\n1\n1 2 3 4 0\n"), ".mesh", "a second section 'Tetrahedra'"},
      {"solid", ".mesh", "MeshVersionFormatted"},
      {"$MeshFormat\n4 0 8\n$EndMeshFormat\n", ".msh", "version '4'"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 4 0 1 1 1 9\n"
       "$EndElements\n",
       ".msh", "node 9"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 11 0 1 1 1 1\n"
       "$EndElements\n",
       ".msh", "type 11"},
      {"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n", ".vtk", "POLYDATA"},
      {"# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nCELLS 1 5\n4.5 0 1 2 3\n", ".vtk",
       "'4.5' is no whole number"},
      {"<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZLibDataCompressor\">", ".vtu", "compressed"},
      {"", ".vtu", "ends before"},
      {"\xfe\xff", ".msh", "UTF-16"},
      {"", ".abc", "'.abc'"},
  };
  for (const auto& [bytes, extension, named] : cases) {
    const std::string message = failure(bytes, extension);
    EXPECT_NE(message.find(named), std::string::npos) << message;
  }
}

TEST(DecodeTetMesh, NeitherCrashesNorHangsOnDamagedFiles) {
  const std::pair<std::string, std::string> files[] = {{encoded(two_tets(), ".vtu"), ".vtu"},
                                                       {encoded(two_tets(), ".msh"), ".msh"},
                                                       {gmsh2_binary(), ".msh"},
                                                       {gmsh4(true), ".msh"},
                                                       {gmsh4(false), ".msh"},
                                                       {vtk(true, false), ".vtk"},
                                                       {vtk(true, true), ".vtk"},
                                                       {vtk(false, true), ".vtk"},
                                                       {vtu("ascii"), ".vtu"},
                                                       {vtu("binary"), ".vtu"},
                                                       {encoded(two_tets(), ".mesh"), ".mesh"}};
  std::mt19937 random(9);
  int refused = 0, read = 0;
  for (const auto& [bytes, extension] : files)
    for (int i = 0; i < 400; ++i) {
      std::string damaged = bytes;
      if (i % 4 == 0) damaged.resize(random() % bytes.size());
      for (int k = 0; k < i % 4 && !damaged.empty(); ++k)
        damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
      try {
        const Decoded decoded = decode(damaged, extension);
        EXPECT_GT(measure_quality(decoded.mesh, Threads(1)).min_volume, 0);
        ++read;
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::Input);
        ++refused;
      }
    }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(read, 100);
}

}  // namespace
}  // namespace softreel
