/// Textures, and lines along edges, in drawn previews.
#include <cmath>

#include <gtest/gtest.h>

#include "render/image/texture_pyramid.h"
#include "tests/render/preview/drawn_preview.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// In a white sky a matt surface shows its albedo.
class PreviewTexture : public DrawnPreview {};

/// A square of edge 2 in rows x rows quads, its texture coordinates 0 to 1 along x and against z.
MotionMesh tiled_square(int rows, const TextureMaps& maps) {
  MotionMesh mesh;
  mesh.appearance = matte(0.5f);
  mesh.times.resize(1);
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c <= rows; ++c) {
      const Vec2f at(static_cast<float>(c) / static_cast<float>(rows),
                     static_cast<float>(r) / static_cast<float>(rows));
      mesh.times[0].positions.emplace_back(2 * at.x() - 1, 0, 1 - 2 * at.y());
      mesh.times[0].normals.emplace_back(0, 1, 0);
      mesh.coloring.coordinates.push_back(at);
    }
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < rows; ++c) {
      const Index a = r * (rows + 1) + c, d = a + rows + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, d + 1}, {a, d + 1, d}});
    }
  mesh.coloring.triangles = mesh.triangles;
  mesh.coloring.maps = maps;
  return mesh;
}

const Vec3f kRed(0.8f, 0.1f, 0.1f), kGreen(0.1f, 0.7f, 0.1f), kBlue(0.1f, 0.2f, 0.9f), kGrey(0.4f, 0.4f, 0.4f);

/// Quarters of one colour each: red and green on top, blue and grey below.
TextureMaps quarters() {
  std::vector<Vec3f> texels;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) texels.push_back(y < 8 ? (x < 8 ? kRed : kGreen) : (x < 8 ? kBlue : kGrey));
  TextureMaps maps;
  maps.base_color = std::make_shared<const ColorTexture>(make_pyramid(16, 16, std::move(texels)));
  return maps;
}

Scene seen_from_above(MotionMesh mesh) {
  Scene scene = scene_in_sky(1);
  scene.camera = camera_above(10, 2.2f);
  scene.meshes = {std::move(mesh)};
  return scene;
}

void expect_color(const DisplayImage& image, const Camera& camera, float x, float z, const Vec3f& albedo) {
  const Vec3f seen = pixel_of(image, camera, Vec3f(x, 0, z));
  EXPECT_LT((seen - 255 * albedo).cwiseAbs().maxCoeff(), 4) << "at " << x << " " << z << ": " << seen.transpose();
}

TEST_F(PreviewTexture, HasItsColoursInTheirPlacesOnCoarseAndOnFineTriangles) {
  for (const int rows : {1, 64}) {  // lit at pixels, and at vertices
    const Scene scene = seen_from_above(tiled_square(rows, quarters()));
    const DisplayImage image = draw(scene);
    expect_color(image, scene.camera, -0.5f, -0.5f, kRed);
    expect_color(image, scene.camera, 0.5f, -0.5f, kGreen);
    expect_color(image, scene.camera, -0.5f, 0.5f, kBlue);
    expect_color(image, scene.camera, 0.5f, 0.5f, kGrey);
  }
}

TEST_F(PreviewTexture, IsScaledMovedAndWrappedAsItsMaterialSays) {
  TextureMaps maps = quarters();
  maps.scale = Vec2f(2, 1);
  maps.offset = Vec2f(0, 0.5f);
  const auto left_to_right = [&](TextureWrap wrap) {
    maps.wrap = wrap;
    const Scene scene = seen_from_above(tiled_square(1, maps));
    const DisplayImage image = draw(scene);
    std::vector<Vec3f> colors;
    for (const float x : {-0.75f, -0.25f, 0.25f, 0.75f})
      colors.push_back(pixel_of(image, scene.camera, Vec3f(x, 0, 0.5f)));
    return colors;
  };
  const auto expect_colors = [&](TextureWrap wrap, const std::vector<Vec3f>& wanted) {
    const std::vector<Vec3f> seen = left_to_right(wrap);
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_LT((seen[k] - 255 * wanted[k]).cwiseAbs().maxCoeff(), 4) << static_cast<int>(wrap) << " " << k;
  };
  // v = 0.75 there: the upper half of the picture.
  expect_colors(TextureWrap::Repeat, {kRed, kGreen, kRed, kGreen});
  expect_colors(TextureWrap::Mirror, {kRed, kGreen, kGreen, kRed});
  expect_colors(TextureWrap::Clamp, {kRed, kGreen, kGreen, kGreen});
}

TEST_F(PreviewTexture, SquaresFarBelowAPixelShowTheirMean) {
  std::vector<Vec3f> texels;
  for (int y = 0; y < 512; ++y)
    for (int x = 0; x < 512; ++x) texels.push_back(Vec3f::Constant((x + y) % 2 == 0 ? 0.1f : 0.7f));
  TextureMaps maps;
  maps.base_color = std::make_shared<const ColorTexture>(make_pyramid(512, 512, std::move(texels)));
  const Scene scene = seen_from_above(tiled_square(1, maps));
  const DisplayImage image = draw(scene);
  for (float x = -0.9f; x < 0.95f; x += 0.1f) expect_color(image, scene.camera, x, 0.3f * x, Vec3f::Constant(0.4f));
}

TEST_F(PreviewTexture, TrianglesWithoutCoordinatesHaveTheBaseColour) {
  MotionMesh mesh = tiled_square(1, quarters());
  mesh.coloring.triangles[1] = {-1, -1, -1};  // the one to the upper left
  const Scene scene = seen_from_above(mesh);
  const DisplayImage image = draw(scene);
  expect_color(image, scene.camera, -0.4f, -0.8f, Vec3f::Constant(0.5f));
  expect_color(image, scene.camera, 0.8f, 0.4f, kGrey);
}

TEST_F(PreviewTexture, ColoursOfVerticesAndHeatWinOverIt) {
  MotionMesh mesh = tiled_square(1, quarters());
  mesh.coloring.colors.assign(4, Vec3f(0.2f, 0.3f, 0.6f));
  const Scene scene = seen_from_above(mesh);
  expect_color(draw(scene), scene.camera, -0.5f, -0.5f, Vec3f(0.2f, 0.3f, 0.6f));
}

TEST_F(PreviewTexture, NormalsAndHeightsTurnTheSurfaceToTheLight) {
  Scene scene = scene_in_sky(0);
  scene.camera = camera_above(10, 2.2f);
  scene.suns.resize(1);
  scene.suns[0].irradiance = Vec3f::Constant(static_cast<float>(M_PI));
  const float half = std::sqrt(0.5f);
  const auto middle = [&](const TextureMaps& maps, const Vec3f& towards_sun) {
    scene.meshes = {tiled_square(1, maps)};
    scene.suns[0].direction = -towards_sun;
    return pixel_of(draw(scene), scene.camera, Vec3f(0.1f, 0, 0.1f)).x();
  };
  const Vec3f right(half, half, 0), left(-half, half, 0), back(0, half, -half), front(0, half, half);
  TextureMaps along_u, along_v, ramp;
  along_u.normal = std::make_shared<const ColorTexture>(make_pyramid(1, 1, std::vector<Vec3f>{Vec3f(half, 0, half)}));
  along_v.normal = std::make_shared<const ColorTexture>(make_pyramid(1, 1, std::vector<Vec3f>{Vec3f(0, half, half)}));
  std::vector<float> heights;
  for (int k = 0; k < 64 * 64; ++k) heights.push_back((static_cast<float>(k % 64) + 0.5f) / 64);
  ramp.bump = std::make_shared<const DataTexture>(make_pyramid(64, 64, std::move(heights)));
  ramp.bump_height = 2;  // as high as the square is wide: a slope of 45 degrees that looks to the left
  const float full = 0.5f * 255;
  EXPECT_NEAR(middle(along_u, right), full, 4);
  EXPECT_NEAR(middle(along_u, left), 0, 4);
  EXPECT_NEAR(middle(along_v, back), full, 4);  // v runs against z
  EXPECT_NEAR(middle(along_v, front), 0, 4);
  EXPECT_NEAR(middle(ramp, left), full, 6);
  EXPECT_NEAR(middle(ramp, right), 0, 6);
  along_u.normal_strength = 0;
  EXPECT_NEAR(middle(along_u, Vec3f(0, 1, 0)), full, 4);
}

TEST_F(PreviewTexture, RoughnessSpreadsTheHighlight) {
  Scene scene = scene_in_sky(0);
  scene.camera = camera_above(100, 2.2f);
  scene.suns.resize(1);
  scene.suns[0].direction = Vec3f(0, -1, 0);
  TextureMaps maps;
  std::vector<float> texels;
  for (int k = 0; k < 16 * 16; ++k) texels.push_back(k % 16 < 8 ? 0.5f : 1.0f);
  maps.roughness = std::make_shared<const DataTexture>(make_pyramid(16, 16, std::move(texels)));
  MotionMesh mesh = tiled_square(1, maps);
  mesh.appearance.base_color = Vec3f::Zero();
  mesh.appearance.specular = 1;
  scene.meshes = {mesh};
  const DisplayImage image = draw(scene);
  const float fine = pixel_of(image, scene.camera, Vec3f(-0.5f, 0, 0)).x(),
              rough = pixel_of(image, scene.camera, Vec3f(0.5f, 0, 0)).x();
  // Straight above the peak of GGX is 1 / (pi alpha^2): 16 times as high for half the roughness.
  EXPECT_GT(fine, 8 * std::max(1.0f, rough));
}

TEST_F(PreviewTexture, LinesLieAlongDrawnEdgesOnly) {
  MotionMesh mesh = square(1, 0, matte(0.6f));
  mesh.lines.emplace();
  mesh.lines->width = 8;
  mesh.lines->color = Vec3f(0.1f, 0, 0);
  mesh.lines->drawn = {0b011, 0b110};  // not the diagonal from (-1, 1) to (1, -1)
  const auto on = [&](float x, float z) {
    const Scene scene = seen_from_above(mesh);
    return pixel_of(draw(scene), scene.camera, Vec3f(x, 0, z));
  };
  const Vec3f line = 255 * mesh.lines->color, plain = Vec3f::Constant(0.6f * 255);
  const float inside = 1 - 2 * 2.2f / kSize;  // two pixels from the rim
  for (const float along : {-0.6f, 0.3f})
    for (const auto& [x, z] :
         {std::pair(inside, along), std::pair(-inside, along), std::pair(along, inside), std::pair(along, -inside)})
      EXPECT_LT((on(x, z) - line).cwiseAbs().maxCoeff(), 8) << x << " " << z << ": " << on(x, z).transpose();
  EXPECT_LT((on(0, 0) - plain).cwiseAbs().maxCoeff(), 3) << "the diagonal is not drawn";
  EXPECT_LT((on(0.4f, 0.5f) - plain).cwiseAbs().maxCoeff(), 3);
  mesh.lines->drawn.clear();
  EXPECT_LT((on(0.01f, 0) - line).cwiseAbs().maxCoeff(), 40) << "now it is";
}

}  // namespace
}  // namespace softreel
