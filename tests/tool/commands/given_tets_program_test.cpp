/// Bodies of tetrahedra made elsewhere, and of graded ones, through the built program.
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

/// A shot of the sphere and its tetrahedra as ball.msh and ball.vtu.
std::string folder_with_tets(const std::string& name) {
  const std::string folder = shot_folder(name);
  for (const char* file : {"ball.msh", "ball.vtu"})
    EXPECT_EQ(
        run(fmt::format("softreel tetrahedralize {0}/sphere.obj -o {0}/{1} --tets 700 --quiet", folder, file)).status,
        0);
  return folder;
}

std::uint32_t pc2_points(const std::string& path) {
  std::uint32_t points = 0;
  std::memcpy(&points, read_text(path).data() + 16, 4);
  return points;
}

json report_of(const std::string& folder) {
  return json::parse(read_text(folder + "/out/ball.report.json"))["bodies"][0];
}

TEST(GivenTets, CarryTheSurfaceBesideThem) {
  const std::string folder = folder_with_tets("given");
  const std::string command = fmt::format(
      "softreel render {0}/shot.toml --output {0}/out --quiet --frames 1-2 --set body.tetrahedra={0}/ball.msh", folder);
  const Outcome outcome = run(command);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json tets = json::parse(run(fmt::format("softreel inspect {}/ball.msh --json", folder)).out);
  EXPECT_EQ(report_of(folder)["tets"], tets["tets"]);
  EXPECT_EQ(report_of(folder)["nodes"], tets["nodes"]);
  // Other tetrahedra are another body, and status says which file it was.
  ASSERT_EQ(
      run(fmt::format("softreel tetrahedralize {0}/sphere.obj -o {0}/ball.msh --tets 900 --quiet", folder)).status, 0);
  const Outcome status =
      run(fmt::format("softreel status {0}/shot.toml --output {0}/out --set body.tetrahedra={0}/ball.msh", folder));
  EXPECT_NE(status.out.find("ball.msh"), std::string::npos) << status.out;
  ASSERT_EQ(run(command).status, 0);
  EXPECT_NE(report_of(folder)["tets"], tets["tets"]);
}

TEST(GivenTets, CarryTheSurfaceWhereverVerticesOfNoFaceAre) {
  const std::string folder = folder_with_tets("given_loose");
  const std::string sets = fmt::format("--set body.tetrahedra={}/ball.msh", folder);
  write_text(folder + "/sphere.obj", sphere_obj(12) + "v 9 9 9\n");
  const Outcome outcome =
      run(fmt::format("softreel simulate {0}/shot.toml --output {0}/out --quiet --frames 1 {1}", folder, sets));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST(GivenTets, AreABodyOfTheirOwnInTheirNodesOrder) {
  const std::string folder = folder_with_tets("given_alone");
  const Outcome outcome = run(fmt::format(
      "softreel export {0}/shot.toml --output {0}/out --quiet --format pc2 --set body.mesh={0}/ball.vtu", folder));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json tets = json::parse(run(fmt::format("softreel inspect {}/ball.vtu --json", folder)).out);
  EXPECT_EQ(pc2_points(folder + "/out/ball.ball.pc2"), tets["nodes"].get<std::uint32_t>());
}

TEST(GivenTets, SayWhichFieldsHaveNoEffectBesideThem) {
  const std::string folder = folder_with_tets("given_beside");
  const auto simulate = [&](const std::string& shot, const std::string& sets) {
    return run(fmt::format("softreel simulate {} --output {}/out --quiet --frames 1 {}", shot, folder, sets));
  };
  const std::string mesh = fmt::format("--set body.mesh={}/ball.vtu ", folder);
  for (const char* tets : {"77", "20000"}) {
    const Outcome outcome = simulate(folder + "/shot.toml", mesh + "--set body.tets=" + tets);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("body.ball.tets has no effect"), std::string::npos) << tets << outcome.err;
  }
  std::string shot = read_text(folder + "/shot.toml");
  const std::size_t line = shot.find("tets = ");
  ASSERT_NE(line, std::string::npos);
  shot.erase(line, shot.find('\n', line) - line);
  write_text(folder + "/plain.toml", shot);
  EXPECT_EQ(simulate(folder + "/plain.toml", mesh).err.find("has no effect"), std::string::npos);
  const Outcome resolved = simulate(folder + "/out/ball.resolved.toml", "");
  EXPECT_EQ(resolved.status, 0) << resolved.err;
  EXPECT_EQ(resolved.err.find("has no effect"), std::string::npos) << "what was not given is not written";
}

TEST(GivenTets, OfAnotherBodyAreRefused) {
  const std::string folder = folder_with_tets("given_wrong");
  write_text(folder + "/big.toml", sphere_shot());
  ASSERT_EQ(
      run(fmt::format("softreel tetrahedralize {0}/sphere.obj --fit 0.5 -o {0}/small.mesh --tets 700 --quiet", folder))
          .status,
      0);
  const auto refused = [&](const std::string& sets, const char* reason) {
    const Outcome outcome = run(fmt::format("softreel simulate {0}/shot.toml --output {0}/out {1}", folder, sets));
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
  };
  refused(fmt::format("--set body.tetrahedra={}/small.mesh", folder), "does not fit");
  refused(fmt::format("--set body.tetrahedra={}/none.mesh", folder), "there is no such mesh file");
  refused(fmt::format("--set body.tetrahedra={}/sphere.obj", folder), "format '.obj'");
  refused(fmt::format("--set body.tetrahedra={0}/ball.msh --set body.mesh={0}/ball.vtu", folder), "names others");
}

TEST(EmbeddedMode, OfAShotIsReadBackFromTheCache) {
  const std::string folder = shot_folder("embedded");
  const auto render = [&](const std::string& output, const std::string& more = "") {
    const Outcome outcome = run(fmt::format(
        "softreel render {0}/shot.toml --output {0}/{1} --quiet --set body.mode=embedded {2}", folder, output, more));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return stored_content(folder + "/" + output + "/ball.0004.png");
  };
  const std::string whole = render("out");
  EXPECT_FALSE(report_of(folder)["tets_from_cache"].get<bool>());
  // The tetrahedra, with their fill, come from the cache and give the bits of a fresh run.
  const std::string stiffer = render("out", "--set material.soft.youngs_modulus=5e4");
  EXPECT_TRUE(report_of(folder)["tets_from_cache"].get<bool>());
  EXPECT_NE(stiffer, whole);
  EXPECT_EQ(render("fresh", "--set material.soft.youngs_modulus=5e4"), stiffer);
}

TEST(ErrorBudget, OfAShotGivesAGradedBody) {
  const std::string folder = shot_folder("graded");
  int before = 100;
  for (const char* budget : {"'\"2%\"'", "0.015", "'\"0.4%\"'"}) {
    const Outcome outcome = run(fmt::format(
        "softreel render {0}/shot.toml --output {0}/out --quiet --frames 1-2 --set body.error={1}", folder, budget));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_GT(report_of(folder)["tets"].get<int>(), before) << budget;
    before = report_of(folder)["tets"].get<int>();
  }
}

}  // namespace
}  // namespace softreel
