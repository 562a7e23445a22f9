/// What the pictures of meshes show, by the colours in them.
#include <filesystem>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "render/image/image_io.h"
#include "tests/support/bcc_bar.h"
#include "tool/report/cut_picture.h"
#include "tool/report/surface_picture.h"

namespace softreel {
namespace {

/// Shares of pixels that are clearly of one colour.
struct Colors {
  double sand = 0, red = 0, blue = 0, purple = 0;
};

Colors colors_of(const std::string& path) {
  const DisplayImage image = read_png(path);
  const double pixel = 1.0 / (image.width * image.height);
  Colors colors;
  for (std::size_t k = 0; k < image.pixels.size(); k += 3) {
    const int r = image.pixels[k], g = image.pixels[k + 1], b = image.pixels[k + 2];
    if (r > g + 12 && g > b + 12 && r < 2 * g) colors.sand += pixel;
    if (r > 2 * g && r > 2 * b) colors.red += pixel;
    if (b > r + 20 && g > r) colors.blue += pixel;
    if (b >= r && r > g + 20) colors.purple += pixel;
  }
  return colors;
}

PictureOptions small_picture(const char* name) {
  PictureOptions options;
  options.path = (std::filesystem::temp_directory_path() / name).string();
  options.size = "96x72";
  return options;
}

TEST(DrawCutPicture, ShowsTheInsideInSandAndTheOutsideInBlue) {
  PictureOptions options = small_picture("softreel_cut.png");
  const TetMesh mesh = testing::bcc_bar({8, 6, 8}, 1);
  options.cut = "x=1";
  draw_cut_picture(mesh, options, Threads(2));
  const Colors whole = colors_of(options.path);
  EXPECT_EQ(whole.sand, 0);
  EXPECT_GT(whole.blue, 0.3);
  options.cut = "x";
  const std::string shown = draw_cut_picture(mesh, options, Threads(2));
  const Colors half = colors_of(options.path);
  EXPECT_GT(half.sand, 0.2);
  EXPECT_GT(half.blue, 0.05);
  EXPECT_NE(shown.find("of " + std::to_string(mesh.tets.size()) + " elements"), std::string::npos) << shown;
  std::filesystem::remove(options.path);
}

TEST(DrawCutPicture, FlatElementsAtTheCutAreRed) {
  PictureOptions options = small_picture("softreel_flat.png");
  options.cut = "z";
  TetMesh mesh = testing::bcc_bar({8, 6, 8}, 1);
  for (Vec3& node : mesh.nodes) node.z() *= 0.02;  // all elements become slivers of a few degrees
  draw_cut_picture(mesh, options, Threads(2));
  EXPECT_EQ(colors_of(options.path).sand, 0);
  EXPECT_GT(colors_of(options.path).red, 0.2);
  std::filesystem::remove(options.path);
}

TEST(DrawCutPicture, AnElementAloneCanBeSeenAndNothingCannot) {
  PictureOptions options = small_picture("softreel_one.png");
  const TetMesh mesh{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}, {{0, 1, 2, 3}}, {}};
  draw_cut_picture(mesh, options, Threads(2));
  EXPECT_GT(colors_of(options.path).blue, 0.1);
  std::filesystem::remove(options.path);
  options.cut = "x=0";
  EXPECT_THROW(draw_cut_picture(mesh, options, Threads(2)), Error);
  EXPECT_FALSE(std::filesystem::exists(options.path));
}

/// A cube of quads; `open` leaves out one side, `turned` turns one side round.
SurfaceMesh cube(bool open, bool turned) {
  SurfaceMesh mesh;
  for (int k = 0; k < 8; ++k) mesh.positions.emplace_back(k & 1, k >> 1 & 1, k >> 2 & 1);
  std::vector<std::array<Index, 4>> quads{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  if (turned) std::swap(quads[5][1], quads[5][3]);
  if (open) quads.erase(quads.begin() + 1);
  for (std::size_t q = 0; q < quads.size(); ++q) {
    const auto& [a, b, c, d] = quads[q];
    mesh.polygons.corner_vertices.insert(mesh.polygons.corner_vertices.end(), {a, b, c, d});
    mesh.polygons.offsets.push_back(static_cast<Index>(4 * q + 4));
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
    mesh.triangle_polygon.insert(mesh.triangle_polygon.end(), 2, static_cast<Index>(q));
  }
  return mesh;
}

TEST(DrawSurfacePicture, ShowsDamageInColour) {
  PictureOptions options = small_picture("softreel_surface.png");
  options.size = "320x240";  // tubes along edges are more than a pixel wide
  const auto drawn = [&](const SurfaceMesh& mesh) {
    draw_surface_picture(mesh, cube(mesh.polygons.size() < 6, false), options, Threads(2));
    return colors_of(options.path);
  };
  const Colors whole = drawn(cube(false, false)), open = drawn(cube(true, false)), turned = drawn(cube(false, true));
  EXPECT_GT(whole.blue, 0.3);
  EXPECT_EQ(whole.red + whole.purple, 0);
  EXPECT_GT(open.red, 0);
  EXPECT_LT(open.purple, 0.01);  // where red and blue share a pixel
  EXPECT_GT(turned.purple, 0.1);
  EXPECT_EQ(turned.red, 0);
  std::filesystem::remove(options.path);
}

TEST(DrawSurfacePicture, SaysWhatIsShown) {
  const PictureOptions options = small_picture("softreel_said.png");
  EXPECT_NE(draw_surface_picture(cube(false, false), cube(false, false), options, Threads(1)).find("no damage"),
            std::string::npos);
  EXPECT_NE(
      draw_surface_picture(cube(true, false), cube(true, false), options, Threads(1)).find("4 boundary edges red"),
      std::string::npos);
  std::filesystem::remove(options.path);
  EXPECT_THROW(draw_surface_picture(SurfaceMesh{}, SurfaceMesh{}, options, Threads(1)), Error);
}

}  // namespace
}  // namespace softreel
