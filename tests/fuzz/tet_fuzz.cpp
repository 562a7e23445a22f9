// The readers of tetrahedra, and what is measured of each mesh.
#include "core/base/check.h"
#include "core/base/error.h"
#include "core/tetmesh/files/tet_mesh_file.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "tests/fuzz/fuzz_target.h"

namespace softreel::fuzz {
namespace {

constexpr const char* kExtensions[] = {".mesh", ".msh", ".vtk", ".vtu"};

void check_mesh(const TetMesh& mesh) {
  CHECK(!mesh.tets.empty());
  for (const Vec3& node : mesh.nodes) CHECK(node.allFinite());
  for (const Tet& tet : mesh.tets)
    for (const Index node : tet) {
      CHECK(node >= 0);
      CHECK(static_cast<std::size_t>(node) < mesh.nodes.size());
    }
  CHECK(measure_quality(mesh, Threads(1)).min_volume > 0);
}

TetMesh two_tets() {
  TetMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  return mesh;
}

template <typename T>
void pack(std::string& bytes, std::initializer_list<T> values, bool big_endian = false) {
  for (const T value : values) {
    std::string one(reinterpret_cast<const char*>(&value), sizeof value);
    if (big_endian) one.assign(one.rbegin(), one.rend());
    bytes += one;
  }
}

std::string binary_gmsh() {
  std::string bytes = "$MeshFormat\n4.1 1 8\n";
  pack<std::int32_t>(bytes, {1});
  bytes += "\n$EndMeshFormat\n$Nodes\n";
  pack<std::uint64_t>(bytes, {1, 4, 1, 4});
  pack<std::int32_t>(bytes, {3, 1, 0});
  pack<std::uint64_t>(bytes, {4, 1, 2, 3, 4});
  pack<double>(bytes, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  bytes += "\n$EndNodes\n$Elements\n";
  pack<std::uint64_t>(bytes, {1, 1, 1, 1});
  pack<std::int32_t>(bytes, {3, 1, 4});
  pack<std::uint64_t>(bytes, {1, 1, 1, 2, 3, 4});
  return bytes + "\n$EndElements\n";
}

std::string binary_vtk() {
  std::string bytes = "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n";
  pack<float>(bytes, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, true);
  bytes += "\nCELLS 1 5\n";
  pack<std::int32_t>(bytes, {4, 0, 1, 2, 3}, true);
  bytes += "\nCELL_TYPES 1\n";
  pack<std::int32_t>(bytes, {10}, true);
  return bytes;
}

constexpr const char* kTextVtk =
    "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 "
    "1\nMETADATA\n"
    "INFORMATION 0\n\nCELLS 3 7\nOFFSETS vtktypeint64\n0 3 7\nCONNECTIVITY vtktypeint64\n0 1 2 0 1 2 3\nCELL_TYPES "
    "2\n5 "
    "10\nCELL_DATA 2\n";
constexpr const char* kTextGmsh =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 "
    "1\n$EndNodes\n"
    "$Elements\n2 2 1 2\n2 1 2 1\n1 1 2 3\n3 1 4 1\n2 1 2 3 4\n$EndElements\n";
constexpr const char* kTextVtu =
    "<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt32\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" "
    "NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 "
    "1</DataArray></Points>"
    "<Cells><DataArray Name=\"connectivity\" type=\"Int32\" format=\"ascii\">0 1 2 3</DataArray><DataArray "
    "Name=\"offsets\" type=\"Int32\" format=\"binary\">BAAAAAQAAAA=</DataArray><DataArray Name=\"types\" "
    "type=\"UInt8\" "
    "format=\"ascii\">10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>\n";

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> list;
  const TetMesh mesh = two_tets();
  for (const std::size_t format : {0U, 1U, 3U}) {
    const std::vector<std::uint8_t> bytes = encode_tet_mesh(mesh, kExtensions[format]);
    list.push_back(static_cast<char>(format) + std::string(bytes.begin(), bytes.end()));
  }
  list.push_back("\1" + binary_gmsh());
  list.push_back(std::string("\1") + kTextGmsh);
  list.push_back("\2" + binary_vtk());
  list.push_back(std::string("\2") + kTextVtk);
  list.push_back(std::string("\3") + kTextVtu);
  return list;
}

}  // namespace softreel::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace softreel;
  return fuzz::run_input(data, size, [](std::uint8_t format, std::string_view bytes) {
    const char* const extension = fuzz::kExtensions[format % std::size(fuzz::kExtensions)];
    fuzz::check_mesh(decode_tet_mesh("fuzz", bytes, extension, Log{}));
  });
}
