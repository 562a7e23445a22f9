/// What is said of a shot's results, and what is removed of them.
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

class Status : public ::testing::Test {
 protected:
  void start(const std::string& name) { folder_ = shot_folder(name); }

  Outcome softreel(const std::string& command, const std::string& options = "") {
    return run(fmt::format("softreel {0} {1}/shot.toml --output {1}/out {2}", command, folder_, options));
  }
  void render(const std::string& options = "") {
    const Outcome outcome = softreel("render", "--quiet " + options);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }
  /// The status of one stage; null if it is not listed.
  json stage(const std::string& name, const std::string& options = "") {
    const Outcome outcome = softreel("status", "--json " + options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const json status = json::parse(outcome.out);
    for (const json& one : status["stages"])
      if (one["stage"] == name) return one;
    return {};
  }
  std::vector<std::string> cached(const std::string& kind) { return files_under(folder_ + "/out/.cache/2/" + kind); }

  std::string folder_;
};

TEST_F(Status, SaysMissingBeforeAndDoneAfter) {
  start("done");
  EXPECT_EQ(stage("tetrahedra")["condition"], "missing");
  EXPECT_EQ(stage("simulation")["missing"], json({1, 2, 3, 4}));
  EXPECT_EQ(stage("pictures")["missing"], json({1, 2, 3, 4}));
  EXPECT_EQ(softreel("status", "--exit-code").status, 1);
  EXPECT_FALSE(exists(folder_ + "/out")) << "asking makes nothing";
  render();
  EXPECT_EQ(stage("tetrahedra")["condition"], "done");
  EXPECT_EQ(stage("simulation")["done"], json({1, 2, 3, 4}));
  EXPECT_EQ(stage("pictures")["done"], json({1, 2, 3, 4}));
  EXPECT_EQ(softreel("status", "--exit-code").status, 0);
}

TEST_F(Status, NamesTheFieldThatMadeFramesStaleWithOldAndNewValue) {
  start("stale");
  render();
  const std::string edits =
      "--set 'body.ball.pull[0].active=[1,3]' --set solver.max_newton_iterations=9 --set golden.threshold=0.5";
  const json simulation = stage("simulation", edits);
  EXPECT_EQ(simulation["done"], json({1, 2, 3}));
  EXPECT_EQ(simulation["stale"], json({4}));
  ASSERT_EQ(simulation["because"].size(), 1U) << "iterations of statics and golden images concern nothing here";
  EXPECT_EQ(simulation["because"][0]["field"], "body.ball.pull[0].active");
  EXPECT_EQ(simulation["because"][0]["frames"], json({4}));
  EXPECT_EQ(simulation["because"][0]["after"], "[1, 3]");
  const json pictures = stage("pictures", edits + " --set camera.azimuth_deg=60");
  EXPECT_EQ(pictures["stale"], json({1, 2, 3, 4}));
  ASSERT_EQ(pictures["because"].size(), 2U);
  for (const json& reason : pictures["because"])
    EXPECT_EQ(reason["frames"], reason["field"] == "camera.azimuth_deg" ? json({1, 2, 3, 4}) : json({4}))
        << reason["field"];
}

TEST_F(Status, NamesTheContentOfAMeshAlsoWhereItsFolderWasMoved) {
  start("before_moving");
  render();
  const std::string moved = folder_ + "_and_after";
  std::filesystem::remove_all(moved);
  std::filesystem::rename(folder_, moved);
  folder_ = moved;
  EXPECT_EQ(stage("pictures")["done"], json({1, 2, 3, 4})) << "what moves as a whole stays done";
  write_text(folder_ + "/sphere.obj", sphere_obj(7));
  const json pictures = stage("pictures");
  EXPECT_EQ(pictures["stale"], json({1, 2, 3, 4}));
  ASSERT_EQ(pictures["because"].size(), 1U);
  EXPECT_NE(pictures["because"][0]["field"].get<std::string>().find("content of " + folder_), std::string::npos);
}

TEST_F(Status, KnowsFramesOfSeveralVersionsApart) {
  start("versions");
  render();
  render("--frames 2-3 --set camera.azimuth_deg=60");
  const json pictures = stage("pictures");
  EXPECT_EQ(pictures["done"], json({1, 4}));
  EXPECT_EQ(pictures["stale"], json({2, 3}));
  EXPECT_EQ(pictures["because"][0]["field"], "camera.azimuth_deg");
  EXPECT_EQ(pictures["because"][0]["before"], "60");
}

TEST_F(Status, SaysWhyASheetIsStale) {
  start("sheet");
  const std::string with_sheet = "--set output.contact_sheet=true";
  render(with_sheet);
  EXPECT_EQ(stage("sheet", with_sheet)["condition"], "done");
  ASSERT_EQ(softreel("sheet", "--quiet --count 2").status, 0);
  EXPECT_EQ(stage("sheet", with_sheet)["cause"], "it was made of other pictures, or with other settings");
  std::filesystem::remove(folder_ + "/out/ball.0002.png");
  EXPECT_EQ(stage("sheet", with_sheet)["cause"], "not all pictures that it shows are done");
}

TEST_F(Status, SaysThatADamagedManifestKnowsNoPictures) {
  start("manifest");
  render();
  write_text(folder_ + "/out/ball.manifest.json", "");
  const json pictures = stage("pictures");
  EXPECT_EQ(pictures["stale"], json({1, 2, 3, 4}));
  EXPECT_NE(pictures["cause"].get<std::string>().find("damaged or lost"), std::string::npos) << pictures;
}

TEST_F(Status, FindsAChangedMeshAndDamage) {
  start("damage");
  render();
  const std::string state = folder_ + "/out/.cache/2/simulation/" + cached("simulation").front();
  std::string text = read_text(state);
  text[text.size() / 2] ^= 4;
  write_text(state, text);
  write_text(folder_ + "/out/ball.0002.png", "no picture");
  EXPECT_EQ(stage("simulation")["damaged"].size(), 1U);
  EXPECT_EQ(stage("pictures")["damaged"], json({2}));
  write_text(folder_ + "/sphere.obj", sphere_obj(10));
  const json tetrahedra = stage("tetrahedra");
  EXPECT_EQ(tetrahedra["condition"], "missing") << "the old surface is gone, so nothing is known of its tetrahedra";
  const json pictures = stage("pictures");
  EXPECT_EQ(pictures["stale"], json({1, 2, 3, 4}));
  EXPECT_NE(pictures["because"][0]["field"].get<std::string>().find("sphere.obj"), std::string::npos);
}

TEST_F(Status, CleanRemovesWhatTheShotAsItIsDoesNotNeed) {
  start("clean");
  render();
  render("--set camera.azimuth_deg=60");
  render("--set body.ball.tets=500");
  render();
  const auto pictures = cached("files").size();
  const Outcome dry = softreel("clean", "--dry-run");
  EXPECT_EQ(dry.status, 0) << dry.err;
  EXPECT_EQ(cached("files").size(), pictures) << dry.out;
  const Outcome outcome = softreel("clean");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(cached("tetrahedra").size(), 1U);
  EXPECT_EQ(cached("simulation").size(), 4U);
  EXPECT_LT(cached("files").size(), pictures);
  EXPECT_EQ(softreel("status", "--exit-code").status, 0) << "what is needed stays";
  EXPECT_EQ(softreel("clean", "--all").status, 0);
  EXPECT_TRUE(cached("simulation").empty());
  EXPECT_TRUE(exists(folder_ + "/out/ball.0001.png"));
}

TEST_F(Status, KnowsMoviesAndSheetsThatAreNotOfTheShot) {
  start("movie");
  const std::string both = "--set output.movie=true --set output.contact_sheet=true";
  render();
  EXPECT_EQ(stage("movie"), json());
  EXPECT_EQ(stage("movie", both)["condition"], "missing");
  EXPECT_EQ(stage("sheet", both)["condition"], "missing");
  EXPECT_EQ(softreel("status", "--exit-code " + both).status, 1);
  write_text(folder_ + "/out/ball.mp4", "made by hand");
  EXPECT_EQ(stage("movie", both)["condition"], "stale");
  render(both);
  EXPECT_EQ(stage("movie", both)["condition"], "done");
  EXPECT_EQ(stage("sheet", both)["condition"], "done");
  EXPECT_EQ(softreel("status", "--exit-code " + both).status, 0);
  std::filesystem::remove(folder_ + "/out/ball.sheet.png");
  EXPECT_EQ(softreel("status", "--exit-code " + both).status, 1);
}

TEST_F(Status, CleanLeavesWhatAnotherShotInTheCacheNeeds) {
  start("others");
  const std::string cache = fmt::format("--cache {}/cache", folder_);
  render(cache);
  write_text(folder_ + "/second.toml", sphere_shot() + "[gravity]\nacceleration = [0, -1, 0]\n");
  const std::string second = fmt::format("{0}/second.toml --output {0}/second {1}", folder_, cache);
  EXPECT_EQ(run(fmt::format("softreel render {} --quiet", second)).status, 0);
  EXPECT_EQ(softreel("clean", cache).status, 0);
  EXPECT_EQ(run(fmt::format("softreel status {} --exit-code", second)).status, 0);
  std::filesystem::remove(folder_ + "/second.toml");
  EXPECT_EQ(softreel("clean", cache).status, 0);
  EXPECT_EQ(files_under(folder_ + "/cache/2/simulation").size(), 4U) << "a shot that is gone needs nothing";
}

TEST_F(Status, ALimitRemovesWhatWasUsedLongestAgo) {
  start("limit");
  render("--set shot.frames='[1,30]'");
  const Outcome outcome = softreel("clean", "--cache-limit 0.001");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_LE(json::parse(softreel("status", "--json").out)["cache_bytes"].get<double>(), 1e6);
  // The next run makes what it misses, and ends within the limit again.
  render("--set shot.frames='[1,30]' --set camera.azimuth_deg=60 --cache-limit 0.001");
  EXPECT_LE(json::parse(softreel("status", "--json").out)["cache_bytes"].get<double>(), 1e6);
}

TEST_F(Status, CleanOfAnOlderFormatSaysWhatItRemoved) {
  start("older");
  std::filesystem::create_directories(folder_ + "/out/.cache/simulation");
  write_text(folder_ + "/out/.cache/simulation/0123456789abcdef0123456789abcdef", "softreel cache 1\n");
  std::filesystem::create_directories(folder_ + "/out/.cache/tetrahedra");
  write_text(folder_ + "/out/.cache/tetrahedra/notes.txt", "not ours");
  const Outcome outcome = softreel("render", "--quiet");
  EXPECT_NE(outcome.err.find("another format"), std::string::npos) << outcome.err;
  EXPECT_EQ(softreel("clean").status, 0);
  EXPECT_FALSE(exists(folder_ + "/out/.cache/simulation"));
  EXPECT_TRUE(exists(folder_ + "/out/.cache/tetrahedra/notes.txt"))
      << "what softreel did not make is not its to remove";
}

TEST_F(Status, CleanWithoutAnythingToGoByIsRefused) {
  EXPECT_EQ(run("softreel clean").status, 2);
  EXPECT_EQ(run("softreel clean --cache /nowhere").status, 2);
  EXPECT_EQ(run("softreel clean --cache /nowhere --all").status, 2);
  EXPECT_EQ(softreel("clean", "--cache-limit 0").status, 2) << "0 stands for no limit";
}

}  // namespace
}  // namespace softreel
