#include "core/tetmesh/files/tet_mesh_file.h"

#include <iterator>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/tetmesh/files/vtu_file.h"

namespace softreel {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <typename... Args>
void print(Bytes& bytes, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(bytes), format, std::forward<Args>(args)...);
}

/// Gmsh's number of the linear tetrahedron.
constexpr int kGmshTetra = 4;

Bytes encode_as_vtu(const TetMesh& mesh) {
  std::vector<VtuArray> cell_arrays;
  if (!mesh.fill.empty()) cell_arrays.push_back(vtu_array("fill", 1, mesh.fill));
  return encode_vtu(mesh.nodes, mesh.tets, {}, cell_arrays);
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
  if (mesh.fill.empty()) return bytes;
  // Names; times; step, numbers an element, elements.
  print(bytes, "$ElementData\n1\n\"fill\"\n1\n0\n3\n0\n1\n{}\n", mesh.fill.size());
  for (std::size_t e = 0; e < mesh.fill.size(); ++e) print(bytes, "{} {}\n", e + 1, mesh.fill[e]);
  print(bytes, "$EndElementData\n");
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

std::vector<std::uint8_t> encode_tet_mesh(const TetMesh& mesh, const std::string& extension, const Log& log) {
  if (extension == ".vtu") return encode_as_vtu(mesh);
  if (extension == ".msh") return encode_gmsh(mesh);
  if (extension == ".mesh") {
    if (!mesh.fill.empty())
      log.warn(
          "the .mesh file does not say how full the tetrahedra of the embedded mesh are: read again, all count as "
          "full. Write .vtu or .msh to keep it.");
    return encode_medit(mesh);
  }
  throw input_error(
      fmt::format("tetrahedra cannot be written as '{}'. Accepted: .vtu (VTK), .msh (Gmsh 2.2), .mesh "
                  "(Medit). Choose a file name that ends in one of these.",
                  extension));
}

}  // namespace softreel
