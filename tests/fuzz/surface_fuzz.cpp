// The readers of surfaces, and what each import goes through: polygons cut into triangles, facts, repairs.
#include <span>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/mesh/mesh_check.h"
#include "core/mesh/mesh_repair.h"
#include "core/mesh/polygon_triangulation.h"
#include "core/mesh/readers/obj_reader.h"
#include "core/mesh/readers/off_reader.h"
#include "core/mesh/readers/ply_reader.h"
#include "core/mesh/readers/stl_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace softreel::fuzz {
namespace {

using Reader = SurfaceMesh (*)(const detail::MeshSource&, const Log&);
constexpr Reader kReaders[] = {detail::read_obj, detail::read_off, detail::read_ply, detail::read_stl};

void check_indices(std::span<const Index> indices, Index least, std::size_t count) {
  for (const Index i : indices) {
    CHECK(i >= least);
    CHECK(i < static_cast<std::int64_t>(count));
  }
}

/// What import_mesh promises of a reader's result.
void check_polygons(const SurfaceMesh& mesh) {
  const PolygonList& polygons = mesh.polygons;
  CHECK(polygons.offsets.front() == 0);
  CHECK(static_cast<std::size_t>(polygons.offsets.back()) == polygons.corner_vertices.size());
  for (std::size_t p = 0; p < polygons.size(); ++p) CHECK(polygons.offsets[p + 1] - polygons.offsets[p] >= 3);
  check_indices(polygons.corner_vertices, 0, mesh.positions.size());
  check_indices(polygons.corner_textures, -1, mesh.texture_coordinates.size());
  check_indices(polygons.polygon_groups, -1, mesh.groups.size());
  if (!polygons.corner_textures.empty()) CHECK(polygons.corner_textures.size() == polygons.corner_vertices.size());
  if (!polygons.polygon_groups.empty()) CHECK(polygons.polygon_groups.size() == polygons.size());
  for (const VertexGroup& group : mesh.groups) check_indices(group.vertices, 0, mesh.positions.size());
}

void check_triangles(const SurfaceMesh& mesh) {
  CHECK(mesh.triangle_polygon.size() == mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles) {
    check_indices(triangle, 0, mesh.positions.size());
    for (const Index v : triangle) CHECK(mesh.positions[static_cast<std::size_t>(v)].allFinite());
  }
}

std::string packed(std::initializer_list<float> values) {
  std::string bytes;
  for (const float value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  return bytes;
}

std::string binary_stl() {
  std::string bytes(80, ' ');
  bytes += std::string("\2\0\0\0", 4);
  for (const float z : {0.0F, 1.0F}) bytes += packed({0, 0, 1, 0, 0, z, 1, 0, z, 0, 1, z}) + std::string(2, '\0');
  return bytes;
}

std::string binary_ply(const std::string& format, const std::string& three) {
  std::string bytes = "ply\nformat " + format +
                      " 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                      "property uchar group_a%20b\nelement face 2\nproperty list uchar int vertex_indices\nproperty "
                      "short group\nend_header\n";
  for (int v = 0; v < 4; ++v) bytes += packed({v == 1 ? 1.0F : 0.0F, v == 2 ? 1.0F : 0.0F, 0}) + std::string(1, '\1');
  for (int f = 0; f < 2; ++f) bytes += "\3" + three + std::string("\0\7", 2);
  return bytes;
}

}  // namespace

std::vector<std::string> seeds() {
  const std::string obj =
      "# a square\nmtllib a.mtl\no b\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nvt 1 1\nvt 0.5\ng x y\n"
      "f 1/1/1 2/2/1 3/1/1 4/2/1\nusemtl m\nf -4 \\\n-3 -1\nf 1//1 2//1 3//1\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty float y\nproperty float z\nproperty uchar "
      "group_a\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_index\nproperty "
      "list "
      "uchar float texcoord\nelement tristrips 1\nproperty list int int vertex_indices\nelement edge 1\nproperty int "
      "vertex1\nend_header\n0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 1 0 1\n3 0 1 2 6 0 0 1 0 0 1\n6 0 1 2 -1 0 1\n5\n";
  const std::string stl =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
      "endsolid a\n";
  return {
      std::string(1, '\0') + obj,
      "\1OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2 0.5 0.5 0.5\n",
      "\1STNCOFF 3 1 3 # counts\n0 0 0 0 0 1 1 1 1 1 0 0\n1 0 0 0 0 1 1 1 1 1 1 0\n0 1 0 0 0 1 1 1 1 1 0 1\n3 0 1 2\n",
      "\2" + ply,
      "\2" + binary_ply("binary_little_endian", std::string("\0\0\0\0\1\0\0\0\2\0\0\0", 12)),
      "\2" + binary_ply("binary_big_endian", std::string("\0\0\0\0\0\0\0\1\0\0\0\2", 12)),
      "\3" + stl,
      "\3" + binary_stl()};
}

}  // namespace softreel::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace softreel;
  return fuzz::run_input(data, size, [](std::uint8_t format, std::string_view bytes) {
    SurfaceMesh mesh = fuzz::kReaders[format % std::size(fuzz::kReaders)]({"fuzz", bytes}, Log{});
    fuzz::check_polygons(mesh);
    triangulate_polygons(mesh);
    fuzz::check_triangles(mesh);
    describe(check_mesh(mesh));
    repair_mesh(mesh);
    fuzz::check_triangles(mesh);
  });
}
