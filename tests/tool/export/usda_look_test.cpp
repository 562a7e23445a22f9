// Looks in USDA, and what formats leave out of looks.
#include <filesystem>
#include <limits>

#include "tests/tool/export/format_runs.h"
#include "tests/tool/export/readers/usda_reader.h"
#include "tool/export/export_look.h"

namespace softreel {
namespace {

using testing::UsdPrim;

std::unique_ptr<UsdPrim> stage_of(const SurfaceMesh& mesh, const Appearance& look,
                                  const TextureSettings& textures = {}) {
  testing::FormatRun run("usda");
  run.add_body("cloth", mesh);
  run.target().bodies[0].appearance = look;
  run.target().bodies[0].textures = textures;
  run.append(1, mesh.positions);
  return testing::read_usda(run.finish());
}

TEST(UsdaLook, SaysLightGlassAndCoat) {
  Appearance look;
  look.emission = Vec3f(2, 1, 0);
  look.transmission = 1;
  look.ior = 1.25F;
  look.coat = 0.5F;
  look.coat_roughness = 0.25F;
  const auto stage = stage_of(testing::unit_box(), look);
  const UsdPrim& surface = stage->child("shot/Looks/cloth/surface");
  EXPECT_EQ(surface.property("inputs:emissiveColor").value.floats(), std::vector<float>({2, 1, 0}));
  EXPECT_EQ(surface.property("inputs:opacity").value.number, 0);
  EXPECT_EQ(surface.property("inputs:ior").value.number, 1.25);
  EXPECT_EQ(surface.property("inputs:clearcoat").value.number, 0.5);
  EXPECT_EQ(surface.property("inputs:clearcoatRoughness").value.number, 0.25);
}

TEST(UsdaLook, SaysTheStrengthOfReflectionsByTheirIndexAndNothingThatIsTheDefault) {
  Appearance look;
  const auto plain = stage_of(testing::unit_box(), look);
  for (const char* name : {"inputs:emissiveColor", "inputs:opacity", "inputs:ior", "inputs:clearcoat"})
    EXPECT_EQ(plain->child("shot/Looks/cloth/surface").properties.count(name), 0U) << name;
  look.specular = 1;
  const auto strong = stage_of(testing::unit_box(), look);
  const double ior = strong->child("shot/Looks/cloth/surface").property("inputs:ior").value.number;
  EXPECT_NEAR((ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1)), 0.08, 1e-6);
}

TEST(UsdaLook, TexturesAreFoundFromTheFileByItsCoordinates) {
  const testing::TemporaryFolder folder;
  TextureSettings textures;
  textures.base_color = folder.write("a@b.png", "\x89PNG\r\n\x1a\n");
  textures.roughness = folder.write("rough.exr", "\x76\x2f\x31\x01");
  textures.normal = folder.write("normal.png", "\x89PNG\r\n\x1a\n");
  textures.normal_strength = 0.5;
  textures.wrap = TextureWrap::Clamp;
  textures.scale = Vec2(2, 3);
  textures.offset = Vec2(0.25, 0.5);
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("usda");
  run.target().folder = folder.path("");
  run.add_body("cloth", mesh);
  run.target().bodies[0].textures = textures;
  run.append(1, mesh.positions);
  const auto stage = testing::read_usda(run.finish());
  const UsdPrim& look = stage->child("shot/Looks/cloth");
  EXPECT_EQ(look.child("surface").property("inputs:diffuseColor").value.text,
            "/shot/Looks/cloth/base_color.outputs:rgb");
  EXPECT_EQ(look.child("surface").property("inputs:roughness").value.text, "/shot/Looks/cloth/roughness.outputs:g");
  EXPECT_EQ(look.child("surface").property("inputs:normal").value.text, "/shot/Looks/cloth/normal.outputs:rgb");
  EXPECT_EQ(look.child("base_color").property("inputs:file").value.text, "./a@b.png");
  EXPECT_EQ(look.child("base_color").property("inputs:sourceColorSpace").value.text, "sRGB");
  EXPECT_EQ(look.child("roughness").property("inputs:file").value.text, "./rough.exr");
  EXPECT_EQ(look.child("roughness").property("inputs:sourceColorSpace").value.text, "raw");
  EXPECT_EQ(look.child("roughness").property("inputs:wrapT").value.text, "clamp");
  EXPECT_EQ(look.child("normal").property("inputs:scale").value.floats(), std::vector<float>({1, 1, 2, 1}));
  EXPECT_EQ(look.child("normal").property("inputs:bias").value.floats(), std::vector<float>({-0.5F, -0.5F, -1, 0}));
  EXPECT_EQ(look.child("normal").property("inputs:st").value.text, "/shot/Looks/cloth/placed.outputs:result");
  EXPECT_EQ(look.child("placed").property("inputs:in").value.text, "/shot/Looks/cloth/coordinates.outputs:result");
  EXPECT_EQ(look.child("placed").property("inputs:scale").value.floats(), std::vector<float>({2, 3}));
  EXPECT_EQ(look.child("placed").property("inputs:translation").value.floats(), std::vector<float>({0.25F, 0.5F}));
  EXPECT_EQ(look.child("coordinates").property("inputs:varname").value.text, "st");
}

TEST(UsdaLook, ATextureAboveALinkIsToldWhereItIs) {
  namespace fs = std::filesystem;
  const testing::TemporaryFolder folder;
  fs::create_directories(folder.path("far/deep"));
  folder.write("far/color.png", "\x89PNG\r\n\x1a\n");
  fs::create_directory_symlink("far/deep", folder.path("link"));
  TextureSettings textures;
  textures.base_color = folder.path("link/../color.png");
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("usda");
  run.target().folder = folder.path("");
  run.add_body("cloth", mesh);
  run.target().bodies[0].textures = textures;
  run.append(1, mesh.positions);
  const auto stage = testing::read_usda(run.finish());
  EXPECT_EQ(stage->child("shot/Looks/cloth/base_color").property("inputs:file").value.text, "./far/color.png");
}

TEST(UsdaLook, ColoursOfVerticesAreAPrimvarThatTheSurfaceReads) {
  SurfaceMesh mesh = testing::patchwork();
  testing::paint_with_bytes(mesh);
  mesh.colors[0] = Vec3f(-1, 2, std::numeric_limits<float>::quiet_NaN());
  TextureSettings textures;
  textures.vertex_colors = true;
  const auto stage = stage_of(mesh, {}, textures);
  const UsdPrim& look = stage->child("shot/Looks/cloth");
  EXPECT_EQ(look.child("surface").property("inputs:diffuseColor").value.text,
            "/shot/Looks/cloth/vertex_colors.outputs:result");
  EXPECT_EQ(look.child("vertex_colors").property("info:id").value.text, "UsdPrimvarReader_float3");
  EXPECT_EQ(look.child("vertex_colors").property("inputs:varname").value.text, "displayColor");
  const testing::UsdProperty& colors = stage->child("shot/cloth").property("primvars:displayColor");
  EXPECT_EQ(colors.type, "color3f[]");
  EXPECT_EQ(colors.metadata.at("interpolation").text, "vertex");
  std::vector<float> expected{0, 1, 0};
  for (std::size_t v = 1; v < mesh.colors.size(); ++v)
    for (int k = 0; k < 3; ++k) expected.push_back(mesh.colors[v][k]);
  EXPECT_EQ(colors.value.floats(), expected);
  const auto plain = stage_of(mesh, {});
  EXPECT_EQ(plain->child("shot/cloth").properties.count("primvars:displayColor"), 0U) << "they are not shown";
}

TEST(LostLook, NamesInOneLineWhatAFormatLeavesOut) {
  const testing::TemporaryFolder folder;
  MaterialSettings material;
  EXPECT_EQ(lost_look("glb", "gel", material), "");
  EXPECT_EQ(lost_look("usda", "gel", material), "");
  material.textures.vertex_colors = true;
  EXPECT_EQ(lost_look("glb", "gel", material), "") << "COLOR_0 has them";
  EXPECT_EQ(lost_look("usda", "gel", material), "") << "displayColor has them";
  material.textures.base_color = folder.write("color.exr", "\x76\x2f\x31\x01");
  material.textures.bump = folder.path("bump.png");
  material.appearance.subsurface = 0.5F;
  material.appearance.sheen = 1;
  const std::string glb = lost_look("glb", "gel", material), usda = lost_look("usda", "gel", material);
  for (const char* part : {"material.gel", "glb", "neither PNG nor JPEG", "bump_texture", "subsurface"})
    EXPECT_NE(glb.find(part), std::string::npos) << part;
  EXPECT_EQ(glb.find("sheen"), std::string::npos);
  EXPECT_NE(usda.find("sheen"), std::string::npos);
  EXPECT_EQ(usda.find("neither PNG nor JPEG"), std::string::npos);
  EXPECT_EQ(glb.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace softreel
