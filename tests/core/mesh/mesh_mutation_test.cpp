// Files with flipped bytes and cut ends: an import gives a mesh whose indices are sound, or an Error, never anything
// else.
#include <random>

#include <gtest/gtest.h>

#include "core/mesh/mesh_check.h"
#include "core/mesh/mesh_repair.h"
#include "tests/core/mesh/mesh_files.h"

namespace softreel {
namespace {

std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const std::size_t edits = 1 + below(3);
  for (std::size_t e = 0; e < edits && !bytes.empty(); ++e) {
    const std::size_t at = below(bytes.size());
    switch (below(5)) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.erase(at, 1 + below(8));
        break;
      default:
        bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(16)));
    }
  }
  return bytes;
}

void expect_sound(const SurfaceMesh& mesh) {
  const auto in_range = [](Index i, std::size_t count) { return i >= 0 && static_cast<std::size_t>(i) < count; };
  ASSERT_EQ(mesh.triangle_polygon.size(), mesh.triangles.size());
  ASSERT_EQ(static_cast<std::size_t>(mesh.polygons.offsets.back()), mesh.polygons.corner_vertices.size());
  for (const Index v : mesh.polygons.corner_vertices) ASSERT_TRUE(in_range(v, mesh.positions.size()));
  for (const Index t : mesh.polygons.corner_textures)
    ASSERT_TRUE(t == -1 || in_range(t, mesh.texture_coordinates.size()));
  for (const Triangle& t : mesh.triangles)
    for (const Index v : t) ASSERT_TRUE(mesh.positions[static_cast<std::size_t>(v)].allFinite());
  for (const VertexGroup& group : mesh.groups)
    for (const Index v : group.vertices) ASSERT_TRUE(in_range(v, mesh.positions.size()));
}

/// Small meshes that use every feature of their formats.
std::vector<std::pair<std::string, std::string>> seeds() {
  std::string stl(84, '\0');
  stl[80] = 2;
  stl.append(100, '\x3e');
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar group_a\nelement face 2\nproperty list uchar int vertex_indices\nproperty int "
      "group\nend_header\n";
  for (int v = 0; v < 4; ++v) ply += std::string("\0\0\x80\x3f\0\0\0", 7) + std::string(6, static_cast<char>('@' + v));
  for (int f = 0; f < 2; ++f)
    ply += std::string("\x03", 1) + std::string(4, '\0') + std::string("\1\0\0\0\2\0\0\0\7\0\0\0", 12);
  return {
      {"a.obj",
       "o b\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\ng x y\nf 1/1 2/2 3/1 4/2\nusemtl m\nf -4 \\\n-3 -1\n"},
      {"a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
       "group_a\nelement face 1\nproperty list uchar int vertex_index\nproperty list uchar float texcoord\nend_header\n"
       "0 0 0 1\n1 0 0 0\n0 1 0 1\n3 0 1 2 6 0 0 1 0 0 1\n"},
      {"a.ply", ply},
      {"a.stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
       "0\nendloop\nendfacet\nendsolid\n"},
      {"a.stl", stl}};
}

TEST(MutatedMesh, IsAMeshOrAnErrorAndSurvivesCheckAndRepair) {
  std::mt19937 random(20081);
  const testing::TemporaryFolder folder;
  int meshes = 0, errors = 0;
  for (const auto& [name, seed] : seeds()) {
    EXPECT_EQ(testing::import_error(name, seed), "") << name;
    for (int round = 0; round < 400; ++round) {
      const std::string path = folder.write(name, mutated(seed, random));
      try {
        SurfaceMesh mesh = import_mesh(path, Log{});
        expect_sound(mesh);
        describe(check_mesh(mesh));
        repair_mesh(mesh);
        ++meshes;
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::Input);
        ++errors;
      }
    }
  }
  EXPECT_GT(meshes, 100);
  EXPECT_GT(errors, 100);
}

}  // namespace
}  // namespace softreel
