#include "core/tetmesh/tet_mesh_file.h"

#include <bit>
#include <iterator>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {
namespace {

static_assert(std::endian::native == std::endian::little, "the .vtu header says LittleEndian");

using Bytes = std::vector<std::uint8_t>;

template <typename... Args>
void print(Bytes& bytes, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(bytes), format, std::forward<Args>(args)...);
}

template <typename T>
void append_raw(Bytes& bytes, const T& value) {
  const auto* const raw = reinterpret_cast<const std::uint8_t*>(&value);
  bytes.insert(bytes.end(), raw, raw + sizeof(T));
}

/// VTK's number of the linear tetrahedron, Gmsh's number of the same.
constexpr std::uint8_t kVtkTetra = 10;
constexpr int kGmshTetra = 4;

/// Sizes in bytes of the five appended blocks: points, connectivity, offsets, types, fills (there may be none).
std::array<std::uint64_t, 5> vtu_block_sizes(const TetMesh& mesh) {
  const std::uint64_t nodes = mesh.nodes.size(), tets = mesh.tets.size();
  return {nodes * 3 * sizeof(double), tets * 4 * sizeof(Index), tets * sizeof(std::int64_t), tets,
          mesh.fill.size() * sizeof(double)};
}

void print_vtu_header(Bytes& bytes, const TetMesh& mesh) {
  const auto sizes = vtu_block_sizes(mesh);
  std::array<std::uint64_t, 5> offsets{};
  for (std::size_t k = 1; k < 5; ++k) offsets[k] = offsets[k - 1] + sizes[k - 1] + sizeof(std::uint64_t);
  print(bytes,
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
        "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
        mesh.nodes.size(), mesh.tets.size());
  print(
      bytes,
      "<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"appended\" offset=\"{}\"/>\n</Points>\n"
      "<Cells>\n<DataArray type=\"Int32\" Name=\"connectivity\" format=\"appended\" offset=\"{}\"/>\n"
      "<DataArray type=\"Int64\" Name=\"offsets\" format=\"appended\" offset=\"{}\"/>\n"
      "<DataArray type=\"UInt8\" Name=\"types\" format=\"appended\" offset=\"{}\"/>\n</Cells>\n",
      offsets[0], offsets[1], offsets[2], offsets[3]);
  if (!mesh.fill.empty())
    print(bytes,
          "<CellData Scalars=\"fill\">\n<DataArray type=\"Float64\" Name=\"fill\" format=\"appended\" "
          "offset=\"{}\"/>\n</CellData>\n",
          offsets[4]);
  print(bytes, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
}

Bytes encode_vtu(const TetMesh& mesh) {
  Bytes bytes;
  const auto sizes = vtu_block_sizes(mesh);
  bytes.reserve(2048 + sizes[0] + sizes[1] + sizes[2] + sizes[3] + sizes[4]);
  print_vtu_header(bytes, mesh);
  append_raw(bytes, sizes[0]);
  for (const Vec3& p : mesh.nodes)
    for (int k = 0; k < 3; ++k) append_raw(bytes, p[k]);
  append_raw(bytes, sizes[1]);
  for (const Tet& tet : mesh.tets) append_raw(bytes, tet);
  append_raw(bytes, sizes[2]);
  for (std::size_t e = 1; e <= mesh.tets.size(); ++e) append_raw(bytes, static_cast<std::int64_t>(4 * e));
  append_raw(bytes, sizes[3]);
  bytes.insert(bytes.end(), mesh.tets.size(), kVtkTetra);
  if (!mesh.fill.empty()) {
    append_raw(bytes, sizes[4]);
    for (const double fill : mesh.fill) append_raw(bytes, fill);
  }
  print(bytes, "\n</AppendedData>\n</VTKFile>\n");
  return bytes;
}

Bytes encode_gmsh(const TetMesh& mesh) {
  Bytes bytes;
  print(bytes, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", mesh.nodes.size());
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    print(bytes, "{} {} {} {}\n", i + 1, mesh.nodes[i][0], mesh.nodes[i][1], mesh.nodes[i][2]);
  print(bytes, "$EndNodes\n$Elements\n{}\n", mesh.tets.size());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const auto& [a, b, c, d] = mesh.tets[e];
    print(bytes, "{} {} 2 1 1 {} {} {} {}\n", e + 1, kGmshTetra, a + 1, b + 1, c + 1, d + 1);
  }
  print(bytes, "$EndElements\n");
  return bytes;
}

Bytes encode_medit(const TetMesh& mesh) {
  Bytes bytes;
  print(bytes, "MeshVersionFormatted 2\nDimension 3\nVertices\n{}\n", mesh.nodes.size());
  for (const Vec3& p : mesh.nodes) print(bytes, "{} {} {} 0\n", p[0], p[1], p[2]);
  const std::vector<Triangle> boundary = boundary_faces(mesh);
  print(bytes, "Triangles\n{}\n", boundary.size());
  for (const auto& [a, b, c] : boundary) print(bytes, "{} {} {} 0\n", a + 1, b + 1, c + 1);
  print(bytes, "Tetrahedra\n{}\n", mesh.tets.size());
  for (const auto& [a, b, c, d] : mesh.tets) print(bytes, "{} {} {} {} 0\n", a + 1, b + 1, c + 1, d + 1);
  print(bytes, "End\n");
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> encode_tet_mesh(const TetMesh& mesh, const std::string& extension) {
  if (extension == ".vtu") return encode_vtu(mesh);
  if (extension == ".msh") return encode_gmsh(mesh);
  if (extension == ".mesh") return encode_medit(mesh);
  throw input_error(
      fmt::format("tetrahedra cannot be written as '{}'. Accepted: .vtu (VTK), .msh (Gmsh 2.2), .mesh "
                  "(Medit). Choose a file name that ends in one of these.",
                  extension));
}

}  // namespace softreel
