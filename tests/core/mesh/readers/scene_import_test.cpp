#include "core/mesh/readers/scene_import.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numbers>

#include "core/mesh/readers/mesh_import.h"
#include "tests/core/mesh/mesh_files.h"
#include "tests/support/gltf_scene.h"

namespace softreel {
namespace {

using testing::TemporaryFolder;

/// What a file of single numbers holds of 90 degrees.
constexpr double kSingle = 1e-6;

/// Where a node is; clip null: at rest.
Affine place_of(Index node, const SceneAnimation& scene, const SceneClip* clip, double seconds) {
  return SceneNodes(scene, clip, {node}).at(seconds).back();  // those above it stand before it
}

TEST(SceneImport, ReadsNodesAndTheirClip) {
  const TemporaryFolder folder;
  const SceneAnimation scene = import_scene(testing::write_jaw(folder.path("")), Log{});
  ASSERT_EQ(scene.nodes.size(), 2u);
  EXPECT_EQ(scene.nodes[1].name, "jaw");
  EXPECT_EQ(scene.nodes[1].parent, 0);
  ASSERT_EQ(scene.clips.size(), 1u);
  EXPECT_EQ(scene.clips[0].name, "open");
  EXPECT_NEAR(scene.clips[0].seconds, 1, kSingle);
  EXPECT_EQ(place_of(1, scene, nullptr, 0)(Vec3::Zero()), Vec3(0, 1, 0.5));
  // A quarter turn about x takes y to z; half of the time is half of the angle.
  const Affine end = place_of(1, scene, &scene.clips[0], 1);
  EXPECT_LT((end(Vec3(0, 1, 0)) - Vec3(0, 1, 1.5)).norm(), kSingle);
  const Affine half = place_of(1, scene, &scene.clips[0], 0.5);
  const double s = std::numbers::sqrt2 / 2;
  EXPECT_LT((half(Vec3(0, 1, 0)) - Vec3(0, 1 + s, 0.5 + s)).norm(), kSingle);
}

TEST(SceneImport, HoldsTheEndsOfAClip) {
  const TemporaryFolder folder;
  const SceneAnimation scene = import_scene(testing::write_jaw(folder.path("")), Log{});
  const auto turned = [&](double seconds) { return place_of(1, scene, &scene.clips[0], seconds); };
  EXPECT_EQ(turned(-3), turned(0));
  EXPECT_EQ(turned(7), turned(1));
}

TEST(SceneImport, SkinsByLinearBlending) {
  const TemporaryFolder folder;
  const std::string path = testing::write_strip(folder.path(""));
  const SceneAnimation scene = import_scene(path, Log{});
  const SceneVertices vertices(scene, &scene.clips.at(0), {0});
  const SurfaceMesh rest = import_mesh(path, Log{});
  ASSERT_EQ(vertices.count(), 10);
  for (const double seconds : {0.0, 0.7, 2.0}) {
    const double angle = seconds / 2 * std::numbers::pi / 2;
    const std::vector<Index> all{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    const std::vector<Vec3> moved = vertices.at(seconds, all);
    for (std::size_t v = 0; v < 10; ++v) {
      const Vec3& p = rest.positions[v];
      const double upper = double{testing::strip_weights()[v / 2]};
      const Vec3 q = p - Vec3(0, 1, 0);
      const Vec3 turned(std::cos(angle) * q.x() - std::sin(angle) * q.y(),
                        std::sin(angle) * q.x() + std::cos(angle) * q.y(), 0);
      const Vec3 blended = (1 - upper) * p + upper * (turned + Vec3(0, 1, 0));
      EXPECT_LT((moved[v] - blended).norm(), 2 * kSingle) << "vertex " << v << " at " << seconds << " s";
    }
  }
  EXPECT_EQ(vertices.rest(), rest.positions) << "as import_mesh has it, in its order";
}

TEST(SceneImport, MorphsByTheWeightsOfTheClip) {
  const TemporaryFolder folder;
  const SceneAnimation scene = import_scene(testing::write_morph(folder.path("")), Log{});
  const SceneVertices vertices(scene, &scene.clips.at(0), {0});
  EXPECT_EQ(vertices.rest(), (std::vector<Vec3>{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()}));
  const std::vector<Index> last{2};
  EXPECT_LT((vertices.at(1, last)[0] - Vec3(0, 1.5, 0)).norm(), kSingle);
  EXPECT_LT((vertices.at(0.5, last)[0] - Vec3(0, 1.25, 0)).norm(), kSingle);
}

/// The text of a scene file with one part replaced wherever it stands.
std::string with(std::string text, const std::string& part, const std::string& other) {
  EXPECT_NE(text.find(part), std::string::npos);
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + other.size()))
    text.replace(at, part.size(), other);
  return text;
}

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(SceneImport, TwoKeysOfOneTimeAreAStep) {
  const TemporaryFolder folder;
  testing::GltfBuffer buffer;
  const int times = buffer.add_floats({0, 1, 1, 1, 2}, "SCALAR");
  const int places = buffer.add_floats({0, 0, 0, 0, 0, 0, 3, 0, 0, 5, 0, 0, 5, 0, 0}, "VEC3");
  const std::string path = buffer.write(folder.path(""), "step",
                                        fmt::format(R"("scenes": [{{ "nodes": [0] }}], "nodes": [{{ "name": "box" }}],
"animations": [{{ "name": "jump", "channels": [{{ "sampler": 0, "target": {{ "node": 0, "path": "translation" }} }}],
                "samplers": [{{ "input": {}, "output": {} }}] }}])",
                                                    times, places));
  const SceneAnimation scene = import_scene(path, Log{});
  const auto x = [&](double seconds) { return place_of(0, scene, &scene.clips.at(0), seconds).offset.x(); };
  EXPECT_EQ(x(0.999), 0);
  EXPECT_EQ(x(1), 5) << "the last of them holds from its time on";
  EXPECT_EQ(x(1.001), 5);
}

TEST(SceneImport, MorphWeightsOfANodeDoNotMoveAMeshOfItsName) {
  const TemporaryFolder folder;
  std::string text = text_of(testing::write_morph(folder.path("")));
  const std::string mesh = text.substr(text.find("{ \"name\": \"face_mesh\""));
  const std::string other = with(mesh.substr(0, mesh.find("}] }] }") + 7), "face_mesh", "face");
  text = with(text, "\"meshes\": [", "\"meshes\": [" + other + ", ");
  text = with(text, "{ \"name\": \"face\", \"mesh\": 0 }",
              "{ \"name\": \"face\", \"mesh\": 1 }, { \"name\": \"mask\", \"mesh\": 0 }");
  const std::string path = folder.write("morph.gltf", with(text, "\"nodes\": [0]", "\"nodes\": [0, 1]"));
  const SceneAnimation scene = import_scene(path, Log{});
  ASSERT_EQ(scene.meshes.size(), 2u);
  ASSERT_EQ(scene.clips.at(0).morphs.size(), 1u);
  const SceneMesh& moved = scene.meshes[static_cast<std::size_t>(scene.clips[0].morphs[0].mesh)];
  EXPECT_EQ(scene.nodes[static_cast<std::size_t>(moved.node)].name, "face");
}

TEST(SceneImport, PosesTellTimesApartAndContentsTellFilesApart) {
  const TemporaryFolder folder;
  const SceneAnimation scene = import_scene(testing::write_strip(folder.path("")), Log{});
  const SceneVertices vertices(scene, &scene.clips.at(0), {0});
  EXPECT_NE(vertices.pose(0.5), vertices.pose(0.6));
  EXPECT_EQ(vertices.pose(2), vertices.pose(9));
  SceneAnimation other = scene;
  other.meshes[0].influences[3].weight *= 0.5;
  EXPECT_NE(SceneVertices(other, &other.clips[0], {0}).content(), vertices.content());
}

TEST(SceneImport, WarnsOfCurvesThatAssimpDoesNotPassOn) {
  const TemporaryFolder folder;
  std::string path = testing::write_jaw(folder.path(""));
  std::ifstream in(path);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  text.replace(text.find("LINEAR"), 6, "STEP");
  folder.write("jaw.gltf", text);
  testing::Warnings warnings;
  import_scene(path, warnings.log());
  ASSERT_EQ(warnings.lines.size(), 1u);
  EXPECT_NE(warnings.lines[0].find("STEP"), std::string::npos);
}

/// The file with the float `before` of its buffer, the first of this value from the end, replaced by one that is not
/// finite.
std::string with_bad_float(const TemporaryFolder& folder, const std::string& scene, float before, float after) {
  const std::string path = folder.path(scene.substr(scene.find_last_of('/') + 1));
  std::filesystem::path buffer = std::filesystem::path(path).replace_extension(".bin");
  std::ifstream in(buffer, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  std::string old(sizeof(float), '\0'), bad(sizeof(float), '\0');
  std::memcpy(old.data(), &before, sizeof(float));
  std::memcpy(bad.data(), &after, sizeof(float));
  const std::size_t at = bytes.rfind(old);
  EXPECT_NE(at, std::string::npos);
  bytes.replace(at, sizeof(float), bad);
  folder.write(buffer.filename().string(), bytes);
  return path;
}

TEST(SceneImport, RefusesKeysThatAreNotFiniteWithPlaceAndTime) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  const auto refusal = [](const std::string& path) -> std::string {
    try {
      import_scene(path, Log{});
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      return error.what();
    }
    return "no error";
  };
  for (const float bad : {nan, infinite}) {
    const TemporaryFolder folder;
    const std::string turn = refusal(with_bad_float(folder, testing::write_jaw(folder.path("")), 0.70710678F, bad));
    for (const char* part : {"jaw.gltf", "clip 'open'", "key 1 of the rotation of node 'jaw'", "at 1 s", "Export"})
      EXPECT_NE(turn.find(part), std::string::npos) << turn;
    const std::string weight = refusal(with_bad_float(folder, testing::write_morph(folder.path("")), 0.5F, bad));
    for (const char* part : {"morph.gltf", "clip 'lift'", "key 1 of the morph weights of mesh 'face", "at 1 s"})
      EXPECT_NE(weight.find(part), std::string::npos) << weight;
  }
}

TEST(SceneImport, RefusesWhatIsNoScene) {
  const TemporaryFolder folder;
  for (const std::string& path : {folder.path("missing.glb"), folder.write("text.gltf", "no scene at all")}) try {
      import_scene(path, Log{});
      ADD_FAILURE() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      EXPECT_NE(std::string(error.what()).find("Accepted"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace softreel
