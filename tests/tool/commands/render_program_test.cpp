/// The program as its user meets it: rendering, running again, threads, damage, interruption.
#include <algorithm>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

/// Runs and expects success; returns the JSON report.
json render(const std::string& folder, const std::string& output, const std::string& options = "",
            const std::string& command = "render") {
  const Outcome outcome =
      run(fmt::format("softreel {} {}/shot.toml --output {} --quiet --json {}", command, folder, output, options));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return json::parse(outcome.out);
}

/// Every file of two folders has the same content, but for what holds times, paths and threads, and the records of
/// pictures: one that a killed run had not yet written costs the next run some work, and changes no picture.
void expect_equal_folders(const std::string& a, const std::string& b) {
  const auto kept = [](std::vector<std::string> names) {
    std::erase_if(names, [](const std::string& name) {
      return name.ends_with(".report.json") || name.ends_with(".resolved.toml") || name.ends_with(".manifest.json") ||
             name.ends_with(".manifest.lock") || name.find(".cache/2/uses") == 0 || name == ".cache/2/lock" ||
             name.find(".cache/2/picture/") == 0;
    });
    return names;
  };
  const auto names = kept(files_under(a)), others = kept(files_under(b));
  std::vector<std::string> different;
  std::set_symmetric_difference(names.begin(), names.end(), others.begin(), others.end(),
                                std::back_inserter(different));
  ASSERT_EQ(different, std::vector<std::string>()) << a << " against " << b;
  for (const std::string& name : names)
    EXPECT_TRUE(stored_content(a + "/" + name) == stored_content(b + "/" + name)) << name << " differs";
}

TEST(Render, MakesEveryFrameAndSaysSo) {
  const std::string folder = shot_folder("render");
  const json report = render(folder, folder + "/out");
  for (int frame = 1; frame <= 4; ++frame) EXPECT_TRUE(exists(fmt::format("{}/out/ball.{:04}.png", folder, frame)));
  EXPECT_TRUE(exists(folder + "/out/ball.resolved.toml"));
  EXPECT_EQ(report["pictures"]["traced"], 4);
  EXPECT_EQ(report["simulation"]["computed"], 4);
}

TEST(Render, HasTheSameBitsTwiceAndWithAnyNumberOfThreads) {
  const std::string folder = shot_folder("threads", "exr = true\n");
  for (const char* threads : {"1", "2", "4"}) {
    const std::string output = folder + "/out" + threads;
    render(folder, output, fmt::format("--threads {} --set render.auxiliary=true --set render.shutter=0.5", threads));
    for (const char* format : {"obj", "ply", "pc2"})
      render(folder, output,
             fmt::format("--threads {} --format {} --set render.auxiliary=true "
                         "--set render.shutter=0.5",
                         threads, format),
             "export");
  }
  expect_equal_folders(folder + "/out1", folder + "/out2");
  expect_equal_folders(folder + "/out1", folder + "/out4");
}

TEST(Render, SaysThatFarFromTheOriginContactsGetLost) {
  const std::string folder = shot_folder("far");
  const auto said = [&](double x) {
    const Outcome outcome = run(fmt::format(
        "softreel render {0}/shot.toml --output {0}/out --frames 1 --set 'body.translate=[{1}, 0, 0]'", folder, x));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const std::size_t at = outcome.err.find("from the origin");
    EXPECT_EQ(outcome.err.find("from the origin", at == std::string::npos ? at : at + 1), std::string::npos) << "twice";
    return at != std::string::npos;
  };
  EXPECT_TRUE(said(3000));
  EXPECT_TRUE(said(300));
  EXPECT_FALSE(said(60));
}

TEST(Render, ADamagedStateIsSaidAndSimulatedAgainFromTheOneBefore) {
  const std::string folder = shot_folder("damage");
  render(folder, folder + "/out", "", "simulate");
  const std::string states = folder + "/out/.cache/2/simulation/";
  std::string damaged;
  for (const std::string& name : files_under(states)) damaged = states + name;
  const std::string sound = stored_content(damaged);
  std::string flipped = read_text(damaged);
  flipped[flipped.size() / 2] ^= 1;
  write_text(damaged, flipped);
  const Outcome outcome = run(fmt::format("softreel simulate {0}/shot.toml --output {0}/out --quiet --json", folder));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.err.find(damaged + ": damaged cache file"), std::string::npos) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out)["simulation"]["computed"], 1);
  EXPECT_TRUE(stored_content(damaged) == sound);
}

TEST(Render, AnInterruptedRunKeepsItsFramesAndTheNextOneEndsEqual) {
  const std::string folder = shot_folder("interrupt");
  const std::string more = "--set shot.frames='[1,40]' --set render.samples=16";
  render(folder, folder + "/whole", more);
  for (const char* signal : {"TERM", "KILL"}) {
    const std::string output = folder + "/out" + signal;
    // Waits for the third picture, so that the signal comes in the middle of the work.
    const Outcome outcome =
        run(fmt::format("'{0}' render {1}/shot.toml --output {2} --quiet {3} & pid=$!; "
                        "while [ ! -e {2}/ball.0003.png ] && kill -0 $pid 2>/dev/null; do sleep 0.01; done; "
                        "kill -{4} $pid; wait $pid",
                        SOFTREEL_PROGRAM, folder, output, more, signal));
    EXPECT_EQ(outcome.status, std::string(signal) == "TERM" ? 130 : 137) << outcome.err;
    EXPECT_FALSE(exists(output + "/ball.0040.png")) << "the signal came too late to test anything";
    for (int frame = 1; frame <= 40; ++frame) {
      const std::string name = fmt::format("/ball.{:04}.png", frame);
      if (!exists(output + name)) continue;
      EXPECT_TRUE(read_text(output + name) == read_text(folder + "/whole" + name)) << name;
    }
    render(folder, output, more);
    expect_equal_folders(folder + "/whole", output);
  }
}

TEST(Render, AFrameRangeMakesJustThoseFrames) {
  const std::string folder = shot_folder("range");
  render(folder, folder + "/out", "--frames 2-3");
  EXPECT_FALSE(exists(folder + "/out/ball.0001.png"));
  EXPECT_TRUE(exists(folder + "/out/ball.0002.png"));
  EXPECT_TRUE(exists(folder + "/out/ball.0003.png"));
  EXPECT_FALSE(exists(folder + "/out/ball.0004.png"));
}

TEST(Render, EncodesAMovieOfAllFrames) {
  const std::string folder = shot_folder("movie");
  render(folder, folder + "/out", "--set output.movie=true");
  EXPECT_GT(std::filesystem::file_size(folder + "/out/ball.mp4"), 100U);
  const Outcome probe = run(fmt::format(
      "ffprobe -v error -count_frames -select_streams v -show_entries stream=nb_read_frames,width,height -of csv=p=0 "
      "{}/out/ball.mp4",
      folder));
  EXPECT_EQ(probe.out, "64,36,4\n") << probe.err;
}

TEST(Render, EncodesAMovieOfFramesBeforeZeroAndOfOddNames) {
  const std::string folder = shot_folder("negative");
  const std::string output = folder + "/\"it's 100%\"";  // as a shell reads it
  render(folder, output, "--set output.movie=true --set shot.frames='[-2,1]'");
  const Outcome probe = run(fmt::format(
      "ffprobe -v error -count_frames -select_streams v -show_entries stream=nb_read_frames -of csv=p=0 {}/ball.mp4",
      output));
  EXPECT_EQ(probe.out, "4\n") << probe.err;
}

TEST(Render, EncodesAMovieWhateverFfmpegTakesItsPathFor) {
  const std::string folder = shot_folder("addresses");
  for (const auto& [output, name] :
       {std::pair{"-dash", "ball"}, {"a:b", "ball"}, {"http:x", "ball"}, {"a%d", "ball"}, {"out", "s%03d"}}) {
    const Outcome made =
        run(fmt::format("cd {}; softreel render shot.toml '--output={}' --set shot.name={} --frames 1-4 --quiet --set "
                        "output.movie=true",
                        folder, output, name));
    EXPECT_EQ(made.status, 0) << made.err;
    EXPECT_TRUE(exists(fmt::format("{}/{}/{}.mp4", folder, output, name)));
  }
}

TEST(Render, RefusesALineBreakInThePathOfAMovieBeforeTheWork) {
  const std::string folder = shot_folder("line_break"), output = folder + "/a\nb";
  const std::string command = fmt::format("softreel render {}/shot.toml --output '{}' --quiet ", folder, output);
  const Outcome refused = run(command + "--set output.movie=true");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("line break"), std::string::npos) << refused.err;
  EXPECT_FALSE(exists(output));
  EXPECT_EQ(run(command + "--frames 1").status, 0);
}

TEST(Render, PrerollIsSimulatedButNotRendered) {
  const std::string folder = shot_folder("preroll");
  const json report = render(folder, folder + "/out", "--set shot.preroll=5");
  EXPECT_EQ(report["simulation"]["computed"], 9);
  // Five frames under its weight have moved the body before the first picture.
  render(folder, folder + "/without");
  EXPECT_NE(read_text(folder + "/out/ball.0001.png"), read_text(folder + "/without/ball.0001.png"));
}

TEST(Render, PinsThatContradictEachOtherAreNamedBeforeTheWork) {
  const std::string folder = shot_folder("contradiction");
  write_text(folder + "/shot.toml", sphere_shot(R"(
[[body.ball.pin]]
select = { box = { min = [0, 0, 0], max = [1, 0.2, 1] }, unit = "box" }
keys = [ { frame = 1, translate = [0.1, 0, 0] } ]
active = [3, 4]
)"));
  const Outcome outcome = run(fmt::format("softreel render {0}/shot.toml --output {0}/out --quiet", folder));
  EXPECT_EQ(outcome.status, 2);
  for (const char* part : {"frame 3", "body.ball.pin[0]", "body.ball.pin[1]"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\n" << outcome.err;
}

TEST(Render, AStepThatCannotBeSolvedNamesFrameBodyAndElementAndKeepsTheFramesBefore) {
  const std::string folder = shot_folder("unsolved");
  // Without weight the first frame is at rest; the pull of the second wants more than one iteration.
  const Outcome outcome =
      run(fmt::format("softreel render {0}/shot.toml --output {0}/out --quiet --set shot.mode=static --set "
                      "solver.max_newton_iterations=1 --set 'gravity.acceleration=[0,0,0]'",
                      folder));
  EXPECT_EQ(outcome.status, 1);
  for (const char* part : {"frame 2", "\"ball\"", "element"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\n" << outcome.err;
  EXPECT_TRUE(exists(folder + "/out/ball.0001.png"));
  EXPECT_FALSE(exists(folder + "/out/ball.0002.png"));
}

TEST(Render, APullWithoutBoundNamesFrameBodyAndPullAndKeepsTheFramesBefore) {
  const std::string folder = shot_folder("boundless");
  const std::string more = "--quiet --set 'gravity.acceleration=[0,0,0]' --set body.ball.pull[0].stiffness=";
  const Outcome outcome = run(fmt::format("softreel render {0}/shot.toml --output {0}/out {1}1e200", folder, more));
  EXPECT_EQ(outcome.status, 1);
  for (const char* part :
       {"frame 2", "\"ball\"", "body.ball.pull[0]", "1e+200 N/m", "its force is not finite", "Accepted"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\n" << outcome.err;
  EXPECT_TRUE(exists(folder + "/out/ball.0001.png"));
  EXPECT_FALSE(exists(folder + "/out/ball.0002.png"));
  // Far beyond every material, but with forces that are numbers: that is a pin, nearly.
  EXPECT_EQ(run(fmt::format("softreel simulate {0}/shot.toml --output {0}/stiff {1}1e30", folder, more)).status, 0);
}

TEST(Render, PinsThatTurnABodyInsideOutInOneFrameAreFollowed) {
  const std::string folder = shot_folder("inverted");
  write_text(folder + "/shot.toml", sphere_shot(R"(
[[body.ball.pin]]
select = { box = { min = [0, 0.8, 0], max = [1, 1, 1] }, unit = "box" }
keys = [ { frame = 2, ease = "constant" }, { frame = 3, translate = [0, -3, 0], scale = [1, -1, 1] } ]
)"));
  for (const char* linearize : {"auto", "iterated"}) {
    const Outcome outcome = run(fmt::format(
        "softreel simulate {0}/shot.toml --output {0}/{1} --quiet --set solver.linearize={1}", folder, linearize));
    EXPECT_EQ(outcome.status, 0) << linearize << ": " << outcome.err;
  }
}

TEST(Render, StaticFramesThatAreEqualAreTracedOnce) {
  const std::string folder = shot_folder("static");
  const json report = render(folder, folder + "/out",
                             "--set shot.mode=static --set 'body.ball.pull[0].keys=[{frame=1,translate=[0.1,0,0]}]' "
                             "--set shot.independent=true");
  EXPECT_EQ(report["pictures"]["traced"], 1);
  EXPECT_EQ(report["pictures"]["linked"], 3);
}

}  // namespace
}  // namespace softreel
