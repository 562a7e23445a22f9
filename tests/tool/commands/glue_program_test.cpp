/// Glued bodies through the program: one result a frame for both, made anew when either changes, and messages.
#include <filesystem>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

/// A second ball on top of the first, in jelly, and glue between them.
std::string second_ball(double height, const std::string& glue) {
  return fmt::format(R"([body.hat]
mesh = "sphere.obj"
fit = 0.6
translate = [0, {}, 0]
tets = 300
material = "jelly"
[material.jelly]
youngs_modulus = 8e3
[[glue]]
bodies = ["hat", "ball"]
{}
)",
                     height, glue);
}

class GluedBalls : public ::testing::Test {
 protected:
  void start(const std::string& name, double height = 0.97, const std::string& glue = "distance = 0.05") {
    folder_ = shot_folder(name, second_ball(height, glue));
  }
  Outcome softreel(const std::string& command, const std::string& options = "") {
    return run(fmt::format("softreel {0} {1}/shot.toml --output {1}/out {2}", command, folder_, options));
  }
  void simulate(const std::string& options = "") {
    const Outcome outcome = softreel("simulate", "--quiet " + options);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }
  std::string cache(const std::string& stage) const { return folder_ + "/out/.cache/2/" + stage; }

  std::string folder_;
};

TEST_F(GluedBalls, AreOneResultAFrameAndEachHasItsTetrahedra) {
  start("glued");
  simulate();
  EXPECT_EQ(files_under(cache("simulation")).size(), 4U);
  EXPECT_EQ(files_under(cache("tetrahedra")).size(), 2U);
  const json status = json::parse(softreel("status", "--json").out);
  for (const json& stage : status["stages"])
    if (stage["stage"] == "simulation") {
      EXPECT_EQ(stage["done"], json({1, 2, 3, 4})) << stage;
    }
}

TEST_F(GluedBalls, AChangeOfEitherMakesBothAnewAndOneThatIsNoneKeepsBoth) {
  start("changes");
  simulate();

  for (const auto& [edit, count] : {std::pair{"--set material.jelly.youngs_modulus=9e3", 4},
                                    {"--set material.soft.density=900", 4},
                                    {"--set 'glue[0].distance=0.06'", 4},
                                    {"--set 'body.ball.pull[0].active=[1,3]'", 1},
                                    {"--set 'glue[0].active=[1,9]'", 0},
                                    {"--set material.jelly.base_color=[1,0,0]", 0}}) {
    const std::size_t before = files_under(cache("simulation")).size();
    simulate(edit);
    EXPECT_EQ(files_under(cache("simulation")).size() - before, static_cast<std::size_t>(count)) << edit;
  }
}

TEST_F(GluedBalls, ResumeAtALostFrameWithTheSameBits) {
  start("resume", 0.97, "distance = 0.05\nactive = [2, 4]\nclose = 3");
  simulate();
  std::vector<std::string> names = files_under(cache("simulation")), before;
  for (const std::string& name : names) before.push_back(stored_content(cache("simulation") + "/" + name));
  for (std::size_t lost = 0; lost < names.size(); ++lost) {
    std::filesystem::remove(cache("simulation") + "/" + names[lost]);
    simulate();
    EXPECT_EQ(stored_content(cache("simulation") + "/" + names[lost]), before[lost]);
  }
}

TEST_F(GluedBalls, CarryEachOtherAndWithoutGlueDoNot) {
  const auto lowest = [&](const std::string& options) {
    const Outcome outcome = softreel("export", "--format obj --space world --quiet " + options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    double low = 1e300;
    std::istringstream text(read_text(folder_ + "/out/ball.hat.0012.obj"));
    for (std::string line; std::getline(text, line);)
      if (line.starts_with("v ")) {
        double x = 0, y = 0;
        std::istringstream(line.substr(2)) >> x >> y;
        if (x * x + y * y > 0) low = std::min(low, y);  // the file has a vertex at the origin that nothing uses
      }
    return low;
  };
  start("carried");
  const std::string longer =
      "--set shot.frames=[1,12] --set material.soft.youngs_modulus=5e5 --set material.jelly.youngs_modulus=2e5 ";
  EXPECT_GT(lowest(longer), 0.8) << "the ball below is held";
  EXPECT_LT(lowest(longer + "--set 'glue[0].stiffness=0'"), 0.3) << "it falls by a metre in 11 frames";
}

TEST_F(GluedBalls, OfNoStiffnessAreTheFramesOfAShotWithoutGlue) {
  start("none", 0.97, "distance = 0.05\nstiffness = 0");
  simulate();
  const std::size_t count = files_under(cache("simulation")).size();
  EXPECT_EQ(count, 8U) << "each body by itself";
  std::string text = read_text(folder_ + "/shot.toml");
  write_text(folder_ + "/shot.toml", text.substr(0, text.find("[[glue]]")));
  simulate();
  EXPECT_EQ(files_under(cache("simulation")).size(), count);
}

TEST_F(GluedBalls, AreCheckedWithTheDistanceBetweenThem) {
  start("checked", 1.25);
  const Outcome outcome = run(fmt::format("softreel check {}/shot.toml", folder_));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part : {"glue[0]", "points of hat", "the nearest is 0.25 m from ball"})
    EXPECT_NE(outcome.out.find(part), std::string::npos) << part << "\nin\n" << outcome.out;
  EXPECT_NE(outcome.err.find("no selected point of hat is within distance = 0.05 m"), std::string::npos) << outcome.err;
  start("checked_near");
  EXPECT_EQ(run(fmt::format("softreel check {}/shot.toml", folder_)).err, "");
  start("checked_later", 1.25, "distance = 0.05\nactive = [3, 4]");
  EXPECT_EQ(run(fmt::format("softreel check {}/shot.toml", folder_)).err, "") << "they may have come near by then";
}

TEST_F(GluedBalls, TooFarApartOrSelectingNothingIsAWrongInput) {
  start("far", 1.5);
  Outcome outcome = softreel("simulate");
  EXPECT_EQ(outcome.status, 2);
  for (const char* part : {"glue[0]", "shot.toml:", "distance = 0.05 m", "\"hat\"", "\"ball\"", "the nearest is 0.5"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\nin\n" << outcome.err;
  start("nothing", 0.97, "distance = 0.05\nselect = { box = { min = [5, 5, 5], max = [6, 6, 6] } }");
  outcome = softreel("simulate");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("glue[0].select takes no point"), std::string::npos) << outcome.err;
}

TEST_F(GluedBalls, AreRenderedAndPlannedAndCleaned) {
  start("pictures");
  EXPECT_EQ(softreel("render", "--quiet --set render.shutter=0.5 --set render.heat=strain").status, 0);
  const Outcome plan = run(fmt::format("softreel render {0}/shot.toml --dry-run --output {0}/new", folder_));
  EXPECT_NE(plan.out.find("simulate 4 of 4 body frames"), std::string::npos) << "the two are one\n" << plan.out;
  EXPECT_EQ(softreel("status", "--exit-code --set render.shutter=0.5 --set render.heat=strain").status, 0);
  EXPECT_EQ(softreel("clean", "--set render.shutter=0.5 --set render.heat=strain").status, 0);
  EXPECT_EQ(files_under(cache("simulation")).size(), 4U) << "the shot needs them";
}

}  // namespace
}  // namespace softreel
