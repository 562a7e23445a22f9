// Golden images with their records, burn-ins, contact sheets and turntables, through the built program.
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "render/image/image_io.h"
#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class GoldenCauses : public ::testing::Test {
 protected:
  GoldenCauses() : folder_(shot_folder("causes", "[golden]\nframes = [1, 4]\n")) { golden("--update"); }

  Outcome golden(const std::string& more) const {
    return run(fmt::format("softreel golden {0}/shot.toml --output {0}/out {1}", folder_, more));
  }
  std::string folder_;
};

TEST_F(GoldenCauses, AMovedBodyIsAChangedSimulationWithTheFarthestMove) {
  // The first frame is at rest: the body is 3 mm to the right of where it was.
  const Outcome outcome =
      golden("--set 'body.ball.translate=[0.003,0,0]' --set golden.threshold=0 --set golden.frames=[1]");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(has(outcome.err, "the simulation changed")) << outcome.err;
  EXPECT_TRUE(has(outcome.err, "is 3 mm ('ball' vertex")) << outcome.err;
  EXPECT_TRUE(has(outcome.err, "body.ball.translate")) << outcome.err;
}

TEST_F(GoldenCauses, AnotherColourIsAChangedLook) {
  const Outcome outcome = golden("--set 'material.soft.base_color=[0.1,0.9,0.1]'");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(has(outcome.err, "same geometry: the look changed: material.soft.base_color")) << outcome.err;
}

TEST_F(GoldenCauses, AnotherPictureOfTheSameShotIsAChangedRenderer) {
  // As a renderer with an error would have made it: the golden image is another one.
  const DisplayImage grey{64, 36, std::vector<std::uint8_t>(64 * 36 * 3, 128)};
  const std::vector<std::uint8_t> png = encode_png(grey);
  write_text(folder_ + "/golden/ball.0004.png", std::string(png.begin(), png.end()));
  const Outcome outcome = golden("");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(has(outcome.err, "same geometry, same shot: the renderer changed")) << outcome.err;
  EXPECT_TRUE(has(outcome.err, "1 of 2 golden images changed")) << outcome.err;
}

TEST_F(GoldenCauses, ASimulationThatMovedUnseenIsSaidAndPasses) {
  const Outcome outcome =
      golden("--set 'body.ball.translate=[1e-5,0,0]' --set golden.frames=[1] --set golden.threshold=1");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(has(outcome.err, "10 um")) << outcome.err;
}

TEST_F(GoldenCauses, ADamagedRecordIsRefused) {
  write_text(folder_ + "/golden/ball.golden.json", "{\"format\": 1, \"settings\": 3}");
  const Outcome outcome = golden("");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(has(outcome.err, "ball.golden.json")) << outcome.err;
}

TEST_F(GoldenCauses, ThePageHoldsAllItShows) {
  golden("--set 'material.soft.base_color=[0.1,0.9,0.1]'");
  const std::string page = read_text(folder_ + "/out/golden.html");
  for (const char* outside : {"http:", "https:", "<script", "<link", "url("})
    EXPECT_FALSE(has(page, outside)) << outside;
  std::size_t images = 0;
  for (std::size_t at = page.find("src=\""); at != std::string::npos; at = page.find("src=\"", at + 1)) {
    EXPECT_EQ(page.substr(at + 5, 22), "data:image/png;base64,");
    ++images;
  }
  EXPECT_EQ(images, 6u) << "two frames: golden, now and difference";
  EXPECT_TRUE(has(page, "type=\"range\""));
  EXPECT_TRUE(has(page, "material.soft.base_color"));
}

TEST(Golden, SeveralShotsAreComparedAndOneThatFailsStopsNoOther) {
  const std::string folder = shot_folder("several", "[golden]\nframes = [1]\n");
  write_text(folder + "/bad.toml", sphere_shot("[rendr]\n"));
  const auto golden = [&](const std::string& more) {
    return run(fmt::format("softreel golden {0}/bad.toml {0}/shot.toml --output {0}/out --quiet {1}", folder, more));
  };
  const Outcome updated = golden("--update");
  EXPECT_EQ(updated.status, 1);
  EXPECT_TRUE(has(updated.err, "rendr")) << updated.err;
  EXPECT_TRUE(exists(folder + "/golden/ball.0001.png"));
  const Outcome outcome = golden("");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(has(outcome.err, "1 of 2 shots failed; of the others 0 of 1")) << outcome.err;
}

TEST(Golden, LargePicturesAreComparedSmall) {
  const std::string folder = shot_folder("large", "[golden]\nframes = [1]\nmax_width = 32\n");
  ASSERT_EQ(run(fmt::format("softreel golden {0}/shot.toml --output {0}/out --quiet --update", folder)).status, 0);
  const DisplayImage golden = read_png(folder + "/golden/ball.0001.png");
  EXPECT_EQ(golden.width, 32);
  EXPECT_EQ(golden.height, 18);
}

TEST(MotionVectors, BelongToThisFrameAndTheNext) {
  const std::string folder = shot_folder("motion");
  const auto traced = [&](const char* channels, const char* end) {
    const Outcome outcome = run(fmt::format(
        "softreel render {0}/shot.toml --output {0}/out --json --quiet --set output.exr=true --set "
        "'render.channels={1}' "
        "--set 'body.ball.pull[0].keys=[{{frame=1}},{{frame=3,translate=[0.1,0.1,0]}},{{frame=4,translate={2}}}]'",
        folder, channels, end));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out)["pictures"]["traced"].get<int>();
  };
  EXPECT_EQ(traced("[\"depth\"]", "[0.2,0.2,0]"), 4);
  EXPECT_EQ(traced("[\"depth\"]", "[0.3,0.2,0]"), 1) << "the last frame alone is another one";
  EXPECT_EQ(traced("[\"motion\"]", "[0.2,0.2,0]"), 4);
  EXPECT_EQ(traced("[\"motion\"]", "[0.3,0.2,0]"), 2) << "and the frame before shows where it will be";
}

TEST(BurnedIn, TheFrameIsInThePictureAndNothingIsTracedAgain) {
  const std::string folder = shot_folder("burnin");
  const auto render = [&](const std::string& more) {
    return run(
        fmt::format("softreel render {0}/shot.toml --output {0}/out --frames 1-2 --json --quiet {1}", folder, more));
  };
  ASSERT_EQ(render("").status, 0);
  const DisplayImage plain = read_png(folder + "/out/ball.0001.png");
  const Outcome burned = render("--set output.burn_in=true");
  ASSERT_EQ(burned.status, 0) << burned.err;
  EXPECT_EQ(json::parse(burned.out)["pictures"]["traced"], 0);
  const DisplayImage with = read_png(folder + "/out/ball.0001.png");
  int upper = 0, lower = 0;
  for (std::size_t k = 0; k < plain.pixels.size(); ++k)
    if (plain.pixels[k] != with.pixels[k]) (k < plain.pixels.size() / 2 ? upper : lower) += 1;
  EXPECT_EQ(upper, 0);
  EXPECT_GT(lower, 100);
  EXPECT_NE(read_text(folder + "/out/ball.0001.png"), read_text(folder + "/out/ball.0002.png"));
  ASSERT_EQ(render("").status, 0);
  EXPECT_EQ(read_png(folder + "/out/ball.0001.png").pixels, plain.pixels);
}

TEST(BurnedIn, EqualFramesStillSayTheirOwnNumbers) {
  // Two frames at rest look the same; with their numbers in them they do not.
  const std::string folder = shot_folder("burnequal");
  ASSERT_EQ(
      run(fmt::format("softreel render {0}/shot.toml --output {0}/out --frames 1-2 --quiet --set output.burn_in=true "
                      "--set shot.mode=static --set gravity.acceleration=[0,0,0] --set 'body.ball.pull=[]'",
                      folder))
          .status,
      0);
  EXPECT_NE(read_text(folder + "/out/ball.0001.png"), read_text(folder + "/out/ball.0002.png"));
}

TEST(Sheet, RendersOnlyItsFramesAndIsNotMadeTwice) {
  const std::string folder = shot_folder("sheet");
  const auto sheet = [&] {
    return run(
        fmt::format("softreel sheet {0}/shot.toml --output {0}/out --count 2 --columns 2 --json --quiet", folder));
  };
  const Outcome first = sheet();
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(json::parse(first.out)["pictures"]["traced"], 2);
  EXPECT_TRUE(exists(folder + "/out/ball.0001.png"));
  EXPECT_FALSE(exists(folder + "/out/ball.0002.png"));
  EXPECT_TRUE(exists(folder + "/out/ball.0004.png"));
  const DisplayImage picture = read_png(folder + "/out/ball.sheet.png");
  EXPECT_GT(picture.width, 128);
  const Outcome second = sheet();
  EXPECT_FALSE(json::parse(second.out)["stages"].contains("sheet")) << "it was there";
}

TEST(Sheet, AsAnOptionOfTheShotFollowsItsFrames) {
  const std::string folder = shot_folder("sheetoption");
  const auto render = [&](const std::string& more) {
    return run(fmt::format("softreel render {0}/shot.toml --output {0}/out --quiet --set output.contact_sheet=true {1}",
                           folder, more));
  };
  ASSERT_EQ(render("").status, 0);
  const std::string before = read_text(folder + "/out/ball.sheet.png");
  ASSERT_EQ(render("--set output.exposure=1").status, 0);
  EXPECT_NE(read_text(folder + "/out/ball.sheet.png"), before);
}

TEST(Sheet, WithoutPngsIsRefused) {
  const std::string folder = shot_folder("sheetpng");
  const Outcome outcome =
      run(fmt::format("softreel sheet {0}/shot.toml --output {0}/out --set output.png=false", folder));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(has(outcome.err, "output.png")) << outcome.err;
}

TEST(Turntable, TurnsTheCameraOnceRoundTheBody) {
  const std::string folder = shot_folder("turntable");
  // A red lamp to the right of the camera: it is behind the ball after half a turn.
  const std::string lamp =
      "--set camera.azimuth_deg=0 --set environment.zenith=[0,0,0] --set environment.horizon=[0,0,0] "
      "--set environment.nadir=[0,0,0] --set 'light=[{type=\"area\",center=[4,0.5,0],aim=[0,0.5,0],"
      "size=[2,2],color=[1,0,0],power=900,visible=false}]'";
  const auto turn = [&] {
    return run(fmt::format("softreel render {0}/shot.toml --turntable 4 --frames 3 --output {0}/out --json --quiet {1}",
                           folder, lamp));
  };
  const Outcome outcome = turn();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out)["pictures"]["traced"], 4);
  const auto red = [&](int picture) {
    const DisplayImage image = read_png(fmt::format("{}/out/ball.turntable.{:04}.png", folder, picture));
    std::array<int, 2> halves{};
    // The ball's middle: the ground round it is lit too.
    for (int y = 8; y < 18; ++y)
      for (int x = 25; x < 39; ++x)
        halves[x < 32 ? 0 : 1] += image.pixels[3 * static_cast<std::size_t>(y * image.width + x)];
    return halves;
  };
  const std::array<int, 2> front = red(1), right = red(2), back = red(3), left = red(4);
  EXPECT_GT(front[1], 2 * front[0]) << "lit from the right";
  EXPECT_GT(back[0], 2 * back[1]) << "seen from behind, from the left";
  EXPECT_GT(right[0] + right[1], 3 * (left[0] + left[1])) << "beside the lamp all is lit, opposite to it nothing";
  EXPECT_EQ(json::parse(turn().out)["pictures"]["traced"], 0);
}

TEST(Turntable, OfACameraThatLooksStraightDownTurnsThePicture) {
  const std::string folder = shot_folder("turn_down");
  const std::string lamp =
      "--set camera.elevation_deg=90 --set environment.zenith=[0,0,0] --set environment.horizon=[0,0,0] "
      "--set environment.nadir=[0,0,0] --set 'light=[{type=\"area\",center=[4,0.5,0],aim=[0,0.5,0],"
      "size=[2,2],color=[1,0,0],power=900,visible=false}]'";
  const std::string command = fmt::format(
      "softreel render {0}/shot.toml --turntable 4 --frames 3 --output {0}/out --json --quiet {1}", folder, lamp);
  const Outcome first = run(command);
  ASSERT_EQ(first.status, 0) << first.err;
  // Red of the left half and of the right one: the lamp is to the right at first, and to the left after half a turn.
  const auto red = [&](int picture) {
    const DisplayImage image = read_png(fmt::format("{}/out/ball.turntable.{:04}.png", folder, picture));
    std::array<double, 2> halves{};
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        halves[x < image.width / 2 ? 0 : 1] += image.pixels[3 * static_cast<std::size_t>(y * image.width + x)];
    return halves;
  };
  EXPECT_GT(red(1)[1], 1.2 * red(1)[0]);
  EXPECT_GT(red(3)[0], 1.2 * red(3)[1]);
  const json again = json::parse(run(command).out);
  EXPECT_EQ(again["pictures"]["kept"], 4);
  EXPECT_GT(again["pictures"]["saved_seconds"], 0.0);
}

TEST(Turntable, LeavesNothingOfALongerTurnBesideAShorterOne) {
  const std::string folder = shot_folder("turns");
  const auto turn = [&](const std::string& options) {
    const Outcome outcome =
        run(fmt::format("softreel render {0}/shot.toml --frames 3 --output {0}/out --quiet --set output.movie=true {1}",
                        folder, options));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  };
  const auto pictures = [&] {
    std::set<std::string> names;
    for (const std::string& name : files_under(folder + "/out"))
      if (name.starts_with("ball.turntable.") && name.ends_with(".png")) names.insert(name);
    return names;
  };
  turn("--turntable 4");
  EXPECT_EQ(pictures().size(), 4U);
  turn("--turntable 2 --set environment.zenith=[0.9,0.2,0.1]");
  EXPECT_EQ(pictures(), (std::set<std::string>{"ball.turntable.0001.png", "ball.turntable.0002.png"}));
  EXPECT_TRUE(exists(folder + "/out/ball.turntable.mp4"));
}

/// A shot's first picture over grey, and that of its movie by the matrix of BT.709, as players take HD for whatever it
/// says.
struct MovieAndPicture {
  MovieAndPicture(const std::string& name, const std::string& options) : folder(shot_folder(name)) {
    const Outcome made = run(
        fmt::format("softreel render {0}/shot.toml --frames 1-4 --output {0}/out --quiet --set output.movie=true {1}",
                    folder, options));
    EXPECT_EQ(made.status, 0) << made.err;
    const Outcome decoded =
        run(fmt::format("ffmpeg -loglevel error -i {0}/out/ball.mp4 -frames:v 1 -vf "
                        "scale=in_color_matrix=bt709,format=rgb24 -f rawvideo "
                        "{0}/frame.raw",
                        folder));
    EXPECT_EQ(decoded.status, 0) << decoded.err;
    for (const char c : read_text(folder + "/frame.raw")) frame.push_back(static_cast<unsigned char>(c));
    for (const std::uint8_t value : over_grey(read_png(folder + "/out/ball.0001.png")).pixels) picture.push_back(value);
    EXPECT_EQ(frame.size(), picture.size());
  }
  std::string folder;
  std::vector<int> frame, picture;
};

TEST(Movie, HasTheColoursOfItsPicturesAndSaysHowTheyAreCoded) {
  const MovieAndPicture red("movie_colours",
                            "--set environment.zenith=[0.9,0.02,0.01] --set environment.horizon=[0.9,0.02,0.01]");
  const Outcome said = run(fmt::format(
      "ffprobe -v error -select_streams v -show_entries stream=color_range,color_space,color_transfer,color_primaries "
      "-of csv=p=0 {}/out/ball.mp4",
      red.folder));
  EXPECT_EQ(said.out, "tv,bt709,iec61966-2-1,bt709\n");
  std::array<double, 3> difference{};
  for (std::size_t k = 0; k < red.frame.size(); ++k)
    difference[k % 3] += 3.0 * (red.frame[k] - red.picture[k]) / static_cast<double>(red.frame.size());
  for (const double of_channel : difference) EXPECT_NEAR(of_channel, 0, 2.5);
}

TEST(Movie, ShowsCaughtShadowsOverGrey) {
  const MovieAndPicture caught("movie_shadow", "--set ground.shadow_catcher=true");
  double difference = 0;
  for (std::size_t k = 0; k < caught.frame.size(); ++k)
    difference += std::abs(caught.frame[k] - caught.picture[k]) / static_cast<double>(caught.frame.size());
  EXPECT_LT(difference, 6);
}

}  // namespace
}  // namespace softreel
