#include <gtest/gtest.h>

#include "core/mesh/mesh_check.h"
#include "tests/core/mesh/mesh_files.h"

namespace softreel {
namespace {

using testing::import_error;
using testing::import_text;

TEST(ImportMesh, SaysWhatIsWrongWithAFileOfNoMesh) {
  const testing::TemporaryFolder folder;
  const auto message = [&](const std::string& path) -> std::string {
    try {
      import_mesh(path, Log{});
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      return error.what();
    }
    return {};
  };
  EXPECT_NE(message(folder.path("absent.obj")).find("absent.obj: there is no such mesh file"), std::string::npos);
  EXPECT_NE(message(folder.path("")).find("folder"), std::string::npos);
  for (const std::string name : {"a.obj", "a.off", "a.ply", "a.stl", "a.glb"})
    EXPECT_NE(message(folder.write(name, "")).find("empty"), std::string::npos) << name;
  for (const std::string name : {"b.obj", "b.off", "b.ply", "b.stl", "b.glb", "b.fbx", "b.unknown", "b"}) {
    const std::string text =
        message(folder.write(name, "It was a dark and stormy night;\nthe rain fell in torrents\n"));
    EXPECT_NE(text.find(name + ":"), std::string::npos) << text;
    EXPECT_NE(text.find("Accepted"), std::string::npos) << text;
  }
  EXPECT_NE(message(folder.write("c.obj", "v 0 0 0\nv 1 0 0\n")).find("2 vertices but no face"), std::string::npos);
}

TEST(ImportMesh, TakesTextBehindAByteOrderMarkAndRefusesUtf16) {
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
  const std::pair<const char*, std::string> files[] = {
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"a.off", "OFF\n3 1 0\n" + corners + "3 0 1 2\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
           corners + "3 0 1 2\n"},
      {"a.stl", "solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\nendsolid\n"}};
  for (const auto& [name, text] : files) {
    EXPECT_EQ(import_text(name, "\xef\xbb\xbf" + text).positions, import_text(name, text).positions) << name;
    std::string wide = "\xff\xfe";
    for (const char c : text) wide += {c, '\0'};
    EXPECT_NE(import_error(name, wide).find(std::string(name) + ": its text is UTF-16"), std::string::npos) << name;
  }
}

TEST(ImportMesh, LeavesOutFacesOfVerticesThatAreNotFiniteButKeepsTheirPlace) {
  const testing::TemporaryFolder folder;
  testing::Warnings warnings;
  const std::string path = folder.write(
      "a.obj", "v 0 0 0\nv nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 inf\nv 1e999 0 0\nf 1 2 3\nf 1 3 4\nf 1 5 6\n");
  const SurfaceMesh mesh = import_mesh(path, warnings.log());
  EXPECT_EQ(mesh.positions.size(), 6U);
  EXPECT_EQ(mesh.polygons.size(), 3U);
  EXPECT_EQ(mesh.triangles, std::vector<Triangle>({{0, 2, 3}}));
  EXPECT_EQ(mesh.triangle_polygon, std::vector<Index>({1}));
  ASSERT_EQ(warnings.lines.size(), 1U);
  EXPECT_NE(warnings.lines[0].find("2 of 3 faces"), std::string::npos);
  EXPECT_EQ(check_mesh(mesh).not_finite, 3);
  EXPECT_NE(import_error("a.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").find("every face"), std::string::npos);
}

TEST(ImportMesh, GivesTheSameSurfaceFromEveryTextFormat) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  const std::string off = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  const SurfaceMesh a = import_text("a.obj", obj), b = import_text("a.off", off);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_NEAR(check_mesh(a).signed_volume, 1.0 / 6, 1e-15);
}

/// glTF of one quad as two triangles under two nodes, one of them mirrored and moved. The buffer holds 4 float
/// positions and 6 short indices.
constexpr const char* kGltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"name":"arm","mesh":0,"children":[1]},{"name":"mirror","mesh":0,"scale":[-1,1,1],"translation":[0,0,5]}],
"meshes":[{"name":"sheet","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"materials":[{"name":"skin"}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
"buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)"
                              "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMA"
                              R"("}]})";

TEST(ImportMesh, PutsTheNodesOfASceneTogetherWithTheirNames) {
  SurfaceMesh mesh;
  try {
    mesh = import_text("scene.gltf", kGltf);
  } catch (const Error& error) {
    if (std::string(error.what()).find("SOFTREEL_WITH_ASSIMP") == std::string::npos) throw;
    GTEST_SKIP() << "built without assimp";
  }
  ASSERT_EQ(mesh.positions.size(), 8U);
  EXPECT_EQ(mesh.positions[2], Vec3(1, 1, 0));
  EXPECT_EQ(mesh.positions[6], Vec3(-1, 1, 5));
  ASSERT_EQ(mesh.triangles.size(), 4U);
  for (const Triangle& t : mesh.triangles) {  // all of them look along +z, the mirrored ones too
    const auto at = [&](std::size_t k) { return mesh.positions[static_cast<std::size_t>(t[k])]; };
    EXPECT_EQ((at(1) - at(0)).cross(at(2) - at(0)), Vec3(0, 0, 1));
  }
  const auto size_of = [&](const std::string& name) {
    for (const VertexGroup& group : mesh.groups)
      if (group.name == name) return group.vertices.size();
    return std::size_t{0};
  };
  EXPECT_EQ(size_of("arm"), 4U);
  EXPECT_EQ(size_of("mirror"), 4U);
  EXPECT_EQ(size_of("skin"), 8U);
}

TEST(ImportMesh, TakesColoursOfGltfAsTheyAre) {
  const std::string text =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1},"indices":2}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":36},
{"buffer":0,"byteOffset":72,"byteLength":6}],
"buffers":[{"byteLength":80,"uri":"data:application/octet-stream;base64,)"
      "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAAAAAAAAAAAAAAAAAAD8AAAAA"
      "AACAPgAAgD4AAIA+AAABAAIAAAA="
      R"("}]})";
  SurfaceMesh mesh;
  try {
    mesh = import_text("colors.gltf", text);
  } catch (const Error& error) {
    if (std::string(error.what()).find("SOFTREEL_WITH_ASSIMP") == std::string::npos) throw;
    GTEST_SKIP() << "built without assimp";
  }
  ASSERT_EQ(mesh.colors.size(), 3U);
  EXPECT_EQ(mesh.colors[0], Vec3f(1, 0, 0));
  EXPECT_EQ(mesh.colors[1], Vec3f(0, 0.5f, 0)) << "linear by its specification";
}

}  // namespace
}  // namespace softreel
