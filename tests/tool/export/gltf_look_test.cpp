// Looks in GLB: extensions of Khronos and embedded pictures.
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "render/image/image_io.h"
#include "tests/tool/export/format_runs.h"
#include "tests/tool/export/readers/glb_reader.h"

namespace softreel {
namespace {

using Json = nlohmann::json;

struct Written {
  Json header;
  std::string binary;
  const Json& material() const { return header.at("materials").at(0); }
  const Json& extension(const std::string& name) const { return material().at("extensions").at(name); }
  std::string picture(const Json& reference) const {
    const Json& texture = header.at("textures").at(reference.at("index").get<std::size_t>());
    const Json& image = header.at("images").at(texture.at("source").get<std::size_t>());
    const Json& view = header.at("bufferViews").at(image.at("bufferView").get<std::size_t>());
    return binary.substr(view.at("byteOffset").get<std::size_t>(), view.at("byteLength").get<std::size_t>());
  }
};

Written written(const SurfaceMesh& mesh, const Appearance& look, const TextureSettings& textures = {}) {
  testing::FormatRun run("glb");
  run.add_body("cloth", mesh);
  run.target().bodies[0].appearance = look;
  run.target().bodies[0].textures = textures;
  run.append(1, mesh.positions);
  const testing::GlbScene scene = testing::read_glb(run.finish());
  return {Json::parse(scene.header), scene.binary};
}

void expect_near(const Json& numbers, const std::vector<double>& expected) {
  ASSERT_EQ(numbers.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(numbers[k].get<double>(), expected[k], 1e-6);
}

std::string file_of(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

TEST(GltfLook, NeedsNoExtensionWhereItSaysNothingMore) {
  const Written file = written(testing::unit_box(), {});
  EXPECT_FALSE(file.header.contains("extensionsUsed"));
  EXPECT_FALSE(file.header.contains("images"));
  EXPECT_FALSE(file.material().contains("extensions"));
  EXPECT_FALSE(file.material().contains("emissiveFactor"));
  EXPECT_TRUE(file.material().at("doubleSided").get<bool>());
}

TEST(GltfLook, SaysLightGlassCoatAndSheenByExtensionsThatItNames) {
  Appearance look;
  look.emission = Vec3f(2, 1, 0);
  look.transmission = 1;
  look.ior = 1.25F;
  look.absorption = Vec3f(1, 2, 4);
  look.coat = 0.5F;
  look.coat_roughness = 0.25F;
  look.sheen = 0.5F;
  look.sheen_color = Vec3f(1, 0.5F, 0);
  const Written file = written(testing::unit_box(), look);
  expect_near(file.material().at("emissiveFactor"), {1, 0.5, 0});
  EXPECT_EQ(file.extension("KHR_materials_emissive_strength").at("emissiveStrength"), 2);
  EXPECT_EQ(file.extension("KHR_materials_transmission").at("transmissionFactor"), 1);
  EXPECT_EQ(file.extension("KHR_materials_ior").at("ior"), 1.25);
  EXPECT_EQ(file.extension("KHR_materials_clearcoat").at("clearcoatFactor"), 0.5);
  EXPECT_EQ(file.extension("KHR_materials_clearcoat").at("clearcoatRoughnessFactor"), 0.25);
  expect_near(file.extension("KHR_materials_sheen").at("sheenColorFactor"), {0.5, 0.25, 0});
  const Json& volume = file.extension("KHR_materials_volume");
  EXPECT_EQ(volume.at("thicknessFactor"), 1);
  EXPECT_EQ(volume.at("attenuationDistance"), 0.25);
  expect_near(volume.at("attenuationColor"), {std::exp(-0.25), std::exp(-0.5), std::exp(-1.0)});
  EXPECT_FALSE(file.material().at("doubleSided").get<bool>()) << "the validator warns of volumes with two sides";
  expect_near(file.material().at("pbrMetallicRoughness").at("baseColorFactor"), {1, 1, 1, 1});
  std::vector<std::string> used;
  for (const auto& [name, object] : file.material().at("extensions").items()) used.push_back(name);
  EXPECT_EQ(file.header.at("extensionsUsed").get<std::vector<std::string>>(), used);
  EXPECT_EQ(used.size(), 6U) << "the index says how strong the reflections are";
}

TEST(GltfLook, SaysHowStrongReflectionsAre) {
  Appearance look;
  look.specular = 1;
  expect_near(written(testing::unit_box(), look).extension("KHR_materials_specular").at("specularColorFactor"),
              {2, 2, 2});
  look.specular = 0;
  EXPECT_EQ(written(testing::unit_box(), look).extension("KHR_materials_specular").at("specularFactor"), 0);
}

TEST(GltfLook, PicturesLieInTheFile) {
  const testing::TemporaryFolder folder;
  const std::string color = file_of(encode_png({1, 1, {200, 100, 50}})), normal = "\xff\xd8\xff of a JPEG";
  TextureSettings textures;
  textures.base_color = folder.write("color.data", color);
  textures.roughness = folder.write("rough.png", file_of(encode_png({2, 1, {10, 20, 30, 40, 50, 60}})));
  textures.normal = folder.write("normal.jpg", normal);
  textures.normal_strength = 0.5;
  textures.wrap = TextureWrap::Mirror;
  textures.scale = Vec2(2, 3);
  textures.offset = Vec2(0.25, 0.5);
  Appearance look;
  look.metallic = 0.5F;
  const Written file = written(testing::patchwork(), look, textures);
  const Json& surface = file.material().at("pbrMetallicRoughness");
  EXPECT_EQ(file.picture(surface.at("baseColorTexture")), color);
  expect_near(surface.at("baseColorFactor"), {1, 1, 1, 1});
  EXPECT_EQ(surface.at("roughnessFactor"), 1);
  const std::string rough = folder.write("back.png", file.picture(surface.at("metallicRoughnessTexture")));
  EXPECT_EQ(read_png(rough).pixels, (std::vector<std::uint8_t>{255, 20, 255, 255, 50, 255}))
      << "blue would take the metal away";
  EXPECT_EQ(file.picture(file.material().at("normalTexture")), normal);
  EXPECT_EQ(file.material().at("normalTexture").at("scale"), 0.5);
  EXPECT_EQ(file.header.at("images")[2].at("mimeType"), "image/jpeg");
  EXPECT_EQ(file.header.at("samplers")[0].at("wrapS"), 33648);
  const Json& transform = surface.at("baseColorTexture").at("extensions").at("KHR_texture_transform");
  expect_near(transform.at("scale"), {2, 3});
  expect_near(transform.at("offset"), {0.25, -2.5});  // at v = 0, below: 1 - 0.5 there, 1 * 3 - 2.5 here
  EXPECT_EQ(file.header.at("extensionsUsed"), Json::array({"KHR_texture_transform"}));
}

testing::GlbScene painted(const SurfaceMesh& mesh, const Appearance& look, bool shows_colors) {
  testing::FormatRun run("glb");
  run.add_body("cloth", mesh);
  run.target().bodies[0].appearance = look;
  run.target().bodies[0].textures.vertex_colors = shows_colors;
  run.append(1, mesh.positions);
  return testing::read_glb(run.finish());
}

TEST(GltfLook, ColoursOfVerticesAreLinearForEveryVertexAndStandAlone) {
  SurfaceMesh mesh = testing::patchwork();
  testing::paint_with_bytes(mesh);
  mesh.colors[0] = Vec3f(-1, 2, std::numeric_limits<float>::quiet_NaN());
  const testing::GlbScene scene = painted(mesh, {}, true);
  EXPECT_EQ(scene.base_color, (std::array<double, 4>{1, 1, 1, 1})) << "it multiplies them";
  ASSERT_EQ(scene.colors.size(), scene.positions.size());
  ASSERT_GT(scene.colors.size(), 3 * mesh.colors.size()) << "no duplicates at seams";
  for (std::size_t c = 0; c < scene.indices.size(); ++c) {
    const auto original = static_cast<std::size_t>(mesh.triangles[c / 3][c % 3]);
    const Vec3f expected = original == 0 ? Vec3f(0, 1, 0) : mesh.colors[original];
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(scene.colors[3 * scene.indices[c] + k], expected[static_cast<Index>(k)]);
  }
}

TEST(GltfLook, ColoursOfVerticesGoToWhiteWithGlass) {
  SurfaceMesh mesh = testing::unit_box();
  mesh.colors.assign(mesh.positions.size(), Vec3f(0.5F, 0, 1));
  Appearance look;
  look.transmission = 0.5F;
  const testing::GlbScene scene = painted(mesh, look, true);
  testing::expect_same_floats(scene.colors, {0.75F, 0.5F, 1});
}

TEST(GltfLook, ColoursThatAreNotShownAreNotWritten) {
  SurfaceMesh mesh = testing::unit_box();
  EXPECT_TRUE(painted(mesh, {}, true).colors.empty()) << "there are none";
  testing::paint_with_bytes(mesh);
  const testing::GlbScene scene = painted(mesh, {}, false);
  EXPECT_TRUE(scene.colors.empty());
  EXPECT_NEAR(scene.base_color[0], 0.8, 1e-6);
  EXPECT_FALSE(painted(mesh, {}, true).colors.empty());
}

TEST(GltfLook, LeavesOtherPicturesOut) {
  const testing::TemporaryFolder folder;
  TextureSettings textures;
  textures.base_color = folder.write("color.exr", "\x76\x2f\x31\x01");
  const Written file = written(testing::patchwork(), {}, textures);
  EXPECT_FALSE(file.header.contains("textures"));
  expect_near(file.material().at("pbrMetallicRoughness").at("baseColorFactor"), {0.8, 0.8, 0.8, 1});
}

}  // namespace
}  // namespace softreel
