/// Textures, vertex colours and heat, through the built program.
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "render/image/image_io.h"
#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

/// sphere.obj of the shot with texture coordinates (its own x and y) and vertex colours (its height).
std::string dressed_sphere() {
  std::string text, coordinates;
  std::istringstream lines(sphere_obj(12));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "v") {
      double x = 0, y = 0, z = 0;
      words >> x >> y >> z;
      text += fmt::format("v {} {} {} {} 0.5 0.5\n", x, y, z, y);
      coordinates += fmt::format("vt {} {}\n", x + 0.5, y);
    } else if (keyword == "f") {
      if (!coordinates.empty()) text += std::exchange(coordinates, "");
      text += "f";
      for (std::string corner; words >> corner;) text += fmt::format(" {0}/{0}", corner);
      text += "\n";
    }
  }
  return text;
}

void write_png(const std::string& path, const std::vector<std::uint8_t>& rgb) {
  const std::vector<std::uint8_t> bytes = encode_png({static_cast<int>(rgb.size() / 3), 1, rgb});
  write_text(path, std::string(bytes.begin(), bytes.end()));
}

class Surface : public ::testing::Test {
 protected:
  void start(const std::string& name) {
    folder_ = shot_folder("surface_" + name);
    write_text(folder_ + "/dressed.obj", dressed_sphere());
    write_png(folder_ + "/stripes.png", {255, 0, 0, 0, 0, 255, 255, 0, 0, 0, 0, 255});
  }
  Outcome render(const std::string& options, const std::string& out = "out") const {
    return run(fmt::format("softreel render {0}/shot.toml --output {0}/{1} --quiet --json {2}", folder_, out, options));
  }
  static std::string set(const std::string& field, const std::string& value) {
    return fmt::format("--set '{}={}' ", field, value);
  }
  std::string dressed() const { return set("body.mesh", folder_ + "/dressed.obj"); }
  std::string texture(const std::string& file = "stripes.png") const {
    return set("material.soft.base_color_texture", folder_ + "/" + file);
  }
  std::string picture(int frame, const std::string& out = "out") const {
    return read_text(fmt::format("{}/{}/ball.{:04}.png", folder_, out, frame));
  }

  std::string folder_;
};

TEST_F(Surface, AnEditedTextureFileMakesNewPicturesAndNothingElse) {
  start("edited");
  const Outcome first = render(dressed() + texture());
  ASSERT_EQ(first.status, 0) << first.err;
  const std::string before = picture(2);
  EXPECT_EQ(json::parse(render(dressed() + texture()).out)["pictures"]["kept"], 4);
  write_png(folder_ + "/stripes.png", {0, 255, 0, 0, 0, 0, 0, 255, 0, 0, 0, 0});
  const json report = json::parse(render(dressed() + texture()).out);
  EXPECT_EQ(report["simulation"]["computed"], 0);
  EXPECT_EQ(report["pictures"]["traced"], 4);
  EXPECT_NE(picture(2), before);
  // The same picture under another name is the same.
  write_png(folder_ + "/copy.png", {0, 255, 0, 0, 0, 0, 0, 255, 0, 0, 0, 0});
  EXPECT_EQ(json::parse(render(dressed() + texture("copy.png")).out)["pictures"]["kept"], 4);
}

TEST_F(Surface, StatusNamesTheMeshWhoseColoursChanged) {
  start("repainted");
  const std::string sets = dressed() + set("material.soft.vertex_colors", "true");
  ASSERT_EQ(render(sets).status, 0);
  std::string text = read_text(folder_ + "/dressed.obj");
  text.replace(text.find("0.5 0.5\n"), 7, "0.9 0.5");
  write_text(folder_ + "/dressed.obj", text);
  const json status =
      json::parse(run(fmt::format("softreel status {0}/shot.toml --output {0}/out --json {1}", folder_, sets)).out);
  for (const json& stage : status["stages"]) {
    if (stage["stage"] != "pictures") continue;
    EXPECT_EQ(stage["stale"], json({1, 2, 3, 4}));
    ASSERT_EQ(stage["because"].size(), 1u) << stage;
    EXPECT_NE(stage["because"][0]["field"].get<std::string>().find("dressed.obj"), std::string::npos) << stage;
  }
}

TEST_F(Surface, AColourOnTheCommandLineTakesThePlaceOfTheTexture) {
  start("override");
  ASSERT_EQ(render(dressed() + set("material.soft.base_color", "[1, 0, 0]"), "plain").status, 0);
  ASSERT_EQ(render(dressed() + texture() + set("material.soft.base_color", "[1, 0, 0]"), "over").status, 0);
  EXPECT_EQ(picture(1, "plain"), picture(1, "over"));
  ASSERT_EQ(render(dressed() + set("material.soft.vertex_colors", "true"), "vertices").status, 0);
  EXPECT_NE(picture(1, "plain"), picture(1, "vertices"));
}

TEST_F(Surface, BodiesOfOneMeshThatSwapTheirMaterialsMakeANewPicture) {
  start("swapped");
  // The materials differ in nothing but the colours of the vertices.
  write_text(folder_ + "/shot.toml", R"(
[shot]
name = "ball"
frames = [1, 1]
[body.a]
mesh = "dressed.obj"
material = "painted"
translate = [-0.6, 0, 0]
tets = 300
[body.b]
mesh = "dressed.obj"
material = "plain"
translate = [0.6, 0, 0]
tets = 300
[material.painted]
vertex_colors = true
[material.plain]
[render]
width = 32
height = 16
samples = 2
[output]
movie = false
)");
  const Outcome first = render("");
  ASSERT_EQ(first.status, 0) << first.err;
  const std::string before = picture(1);
  const json report = json::parse(render(set("body.a.material", "plain") + set("body.b.material", "painted")).out);
  EXPECT_EQ(report["pictures"]["traced"], 1);
  EXPECT_NE(picture(1), before);
}

TEST_F(Surface, WhatIsMissingIsSaidWithFileAndField) {
  start("missing");
  const auto expect_refused = [&](const std::string& options, const std::vector<std::string>& parts) {
    const Outcome outcome = render(options);
    EXPECT_EQ(outcome.status, 2) << options;
    for (const std::string& part : parts) EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  };
  expect_refused(dressed() + texture("gone.png"), {"shot.toml:", "material.soft.base_color_texture", "gone.png"});
  write_text(folder_ + "/damaged.png", "\x89PNG\r\n\x1a\n and nothing");
  expect_refused(dressed() + texture("damaged.png"),
                 {"material.soft.base_color_texture", "damaged.png: cannot be read"});
  expect_refused(texture(), {"material.soft.base_color_texture", "sphere.obj", "no texture coordinates", "Accepted"});
  expect_refused(set("material.soft.vertex_colors", "true"), {"vertex_colors", "sphere.obj", "no colours"});
  expect_refused(set("render.heat", "strain") + set("render.heat_range", "[1, 1]"), {"heat_range", "no extent"});
}

TEST_F(Surface, HeatHasOneRangeForTheShotWhicheverFramesAreRendered) {
  start("heat");
  const std::string heat = set("render.heat", "strain") + set("render.height", "128") + set("render.width", "128");
  ASSERT_EQ(render(heat + "--frames 2-2", "one").status, 0);
  const Outcome all = render(heat, "all");
  ASSERT_EQ(all.status, 0) << all.err;
  EXPECT_EQ(picture(2, "one"), picture(2, "all"));
  EXPECT_EQ(json::parse(render(heat, "all").out)["pictures"]["kept"], 4);
  ASSERT_EQ(render(heat + set("render.heat_range", "[0, 0.01]"), "given").status, 0);
  EXPECT_NE(picture(2, "given"), picture(2, "all"));
  // A new exposure develops the stored picture; the legend on it keeps its colours.
  const Outcome developed = render(heat + set("output.exposure", "-3"), "all");
  ASSERT_EQ(developed.status, 0) << developed.err;
  EXPECT_EQ(json::parse(developed.out)["pictures"]["developed"], 4);
  const DisplayImage dark = read_png(folder_ + "/all/ball.0002.png");
  bool yellow = false;  // the upper end of the bar
  for (std::size_t k = 0; k < dark.pixels.size(); k += 3)
    yellow = yellow || (dark.pixels[k] > 240 && dark.pixels[k + 1] > 200 && dark.pixels[k + 2] < 80);
  EXPECT_TRUE(yellow);
}

}  // namespace
}  // namespace softreel
