/// What the preview shows beside the bodies, through the built program.
#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "render/image/image_io.h"
#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

class PreviewCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    const Outcome outcome = preview("--frames 1");
    if (has_no_egl(outcome)) GTEST_SKIP() << outcome.err;
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }
  Outcome preview(const std::string& options) const {
    return run(
        fmt::format("softreel preview {0}/shot.toml --output {0}/out --json --quiet --set render.width=320 --set "
                    "render.height=180 {1}",
                    folder_, options));
  }
  int written(const std::string& options) const {
    const Outcome outcome = preview(options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? json::parse(outcome.out)["files"]["written"].get<int>() : -1;
  }
  DisplayImage picture(int frame) const {
    return read_png(fmt::format("{}/out/ball.preview.{:04}.png", folder_, frame));
  }

  const std::string folder_ = shot_folder("preview");
};

struct Marks {
  int pink = 0, blue = 0;
};

/// Pixels of the colours of pins and of pulls; the shot has no others like them.
Marks marks_in(const DisplayImage& image) {
  Marks marks;
  for (std::size_t k = 0; k < image.pixels.size(); k += 3) {
    const int r = image.pixels[k], g = image.pixels[k + 1], b = image.pixels[k + 2];
    marks.pink += r > g + 130 && b > g + 50 ? 1 : 0;
    marks.blue += b > r + 150 && g > r + 60 ? 1 : 0;
  }
  return marks;
}

TEST_F(PreviewCommand, MarksAreThereWhileTheirConstraintIsActive) {
  const std::string keyed =
      "--set 'body.ball.pin[0].active=[[1,2]]' --set "
      "'body.ball.pull[0].stiffness=[{frame=2,value=0,ease=\"constant\"},{frame=3,value=500}]' ";
  ASSERT_EQ(written(keyed), 4);
  const Marks first = marks_in(picture(1)), last = marks_in(picture(4));
  EXPECT_GT(first.pink, 20);
  EXPECT_EQ(first.blue, 0) << "a pull without stiffness";
  EXPECT_EQ(last.pink, 0) << "a pin that has ended";
  EXPECT_GT(last.blue, 20);
  ASSERT_EQ(written(keyed + "--gizmos pins"), 4);
  EXPECT_EQ(marks_in(picture(4)).blue, 0);
  EXPECT_GT(marks_in(picture(1)).pink, 20);
  ASSERT_EQ(written(keyed + "--gizmos none"), 4);
  EXPECT_EQ(marks_in(picture(1)).pink, 0);
}

TEST_F(PreviewCommand, IsDrawnAgainOnlyInAnotherStyle) {
  EXPECT_EQ(written("--frames 1-2"), 1) << "the first was there";
  EXPECT_EQ(written("--frames 1-2"), 0);
  EXPECT_EQ(written("--frames 1-2 --mode fast"), 2);
  EXPECT_EQ(written("--frames 1-2 --mode fast --wireframe"), 2);
  EXPECT_EQ(written("--frames 1-2 --mode fast --wireframe --gizmos pins"), 2);
  EXPECT_EQ(written("--frames 1-2 --mode fast --wireframe --gizmos pins --set output.burn_in=true"), 2);
  EXPECT_EQ(written("--frames 1-2 --mode fast --wireframe --gizmos pins --set output.burn_in=true"), 0);
}

TEST_F(PreviewCommand, HeatHasTheLegendOfTheRenderedPicture) {
  const std::string heat = "--frames 3 --set render.heat=strain --set 'render.heat_range=[0,0.2]' ";
  ASSERT_EQ(written(heat + "--gizmos none"), 1);
  ASSERT_EQ(run(fmt::format("softreel render {0}/shot.toml --output {0}/out --quiet --set render.width=320 --set "
                            "render.height=180 {1}",
                            folder_, heat))
                .status,
            0);
  const DisplayImage drawn = picture(3), traced = read_png(folder_ + "/out/ball.0003.png");
  // The coloured bar of the legend: no light falls on it, so its pixels are the same.
  int equal_and_coloured = 0;
  for (std::size_t y = 0; y < 40; ++y)
    for (std::size_t x = 0; x < 140; ++x) {
      const std::size_t k = 3 * (320 * y + x);
      const auto [low, high] = std::minmax({drawn.pixels[k], drawn.pixels[k + 1], drawn.pixels[k + 2]});
      if (high - low > 90 && std::equal(&drawn.pixels[k], &drawn.pixels[k] + 3, &traced.pixels[k]))
        ++equal_and_coloured;
    }
  EXPECT_GT(equal_and_coloured, 150);
}

TEST_F(PreviewCommand, WarnsOnceOfALegendWithoutLetters) {
  const std::string heat = "--set render.heat=strain --set 'render.heat_range=[0,0.2]' --gizmos none ";
  const std::string small = preview(heat + "--frames 1-3 --set 'render.crop=[0,0,0.3,0.5]'").err;
  const std::size_t first = small.find("no room for the letters");
  ASSERT_NE(first, std::string::npos) << small;
  EXPECT_NE(small.find("96 x 90 pixels"), std::string::npos) << small;
  EXPECT_EQ(small.find("no room for the letters", first + 1), std::string::npos) << small;
  EXPECT_EQ(preview(heat + "--frames 1").err.find("no room for the letters"), std::string::npos);
}

TEST_F(PreviewCommand, DrawsWhatCropAndOverscanLeave) {
  ASSERT_EQ(written("--frames 2"), 1);
  const DisplayImage whole = picture(2);
  ASSERT_EQ(written("--frames 2 --set 'render.crop=[0.25,0.2,0.75,0.9]'"), 1) << "another picture";
  const DisplayImage part = picture(2);
  ASSERT_EQ(part.width, 160);
  ASSERT_EQ(part.height, 126);
  int different = 0;
  for (std::size_t y = 0; y < 126; ++y)
    for (std::size_t x = 0; x < 160; ++x)
      different += std::abs(part.pixels[3 * (160 * y + x)] - whole.pixels[3 * (320 * (y + 36) + x + 80)]) > 3 ? 1 : 0;
  EXPECT_LT(different, 160 * 126 / 100);
  ASSERT_EQ(written("--frames 2 --set render.overscan=0.1"), 1);
  EXPECT_EQ(picture(2).width, 384);
  EXPECT_EQ(picture(2).height, 216);
}

TEST_F(PreviewCommand, WarnsOnceOfLightsThatItHasNoRoomFor) {
  std::string lamps;
  for (int k = 0; k < 34; ++k)
    lamps += fmt::format("{}{{type=\"sphere\",center=[{},3,0],radius=0.1,power=5}}", k == 0 ? "" : ",", k);
  const std::string warning = "2 of the shot's 34 lights are left out";
  const std::string many = preview(fmt::format("--frames 1-2 --set 'light=[{}]'", lamps)).err;
  const std::size_t first = many.find(warning);
  ASSERT_NE(first, std::string::npos) << many;
  EXPECT_EQ(many.find(warning, first + 1), std::string::npos) << many;
  EXPECT_EQ(preview("--frames 3").err.find("left out"), std::string::npos);
}

TEST_F(PreviewCommand, BurnsInAtTheLowerEdgeOnly) {
  const DisplayImage plain = picture(1);
  ASSERT_EQ(written("--frames 1 --set output.burn_in=true"), 1);
  const DisplayImage burned = picture(1);
  const std::size_t upper = plain.pixels.size() * 3 / 4;
  EXPECT_TRUE(std::equal(plain.pixels.begin(), plain.pixels.begin() + static_cast<std::ptrdiff_t>(upper),
                         burned.pixels.begin()));
  EXPECT_NE(plain.pixels, burned.pixels);
}

TEST_F(PreviewCommand, AllFramesMakeAMovie) {
  const Outcome some = preview("--frames 1-3 --set output.movie=true");
  EXPECT_EQ(some.status, 0) << some.err;
  EXPECT_FALSE(exists(folder_ + "/out/ball.preview.mp4"));
  const Outcome all = preview("--set output.movie=true");
  EXPECT_EQ(all.status, 0) << all.err;
  EXPECT_TRUE(exists(folder_ + "/out/ball.preview.mp4"));
}

TEST(Preview, RefusesKindsAndModesThatItDoesNotKnow) {
  const std::string folder = shot_folder("preview_refuses");
  for (const auto& [options, said] : {std::pair("--gizmos none,pins", "none stands beside other kinds"),
                                      {"--gizmos springs", "springs"},
                                      {"--mode nice", "mode"}}) {
    const Outcome outcome = run(fmt::format("softreel preview {0}/shot.toml --output {0}/out {1}", folder, options));
    EXPECT_EQ(outcome.status, 2) << options;
    EXPECT_NE(outcome.err.find(said), std::string::npos) << outcome.err;
  }
}

TEST(Preview, TakesAListOfMarksWithCommasOrRepeated) {
  const std::string folder = shot_folder("preview_marks");
  for (const char* options : {"--gizmos pins,pulls,regions", "--gizmos=pins,pulls", "--gizmos pins --gizmos regions"}) {
    const Outcome outcome =
        run(fmt::format("softreel preview {0}/shot.toml --output {0}/out --dry-run {1}", folder, options));
    EXPECT_EQ(outcome.status, 0) << options << outcome.err;
  }
}

}  // namespace
}  // namespace softreel
