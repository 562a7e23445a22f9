/// Golden images, exports, previews, plans and facts, through the built program.
#include <cmath>
#include <cstring>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

TEST(Golden, FailsOnChangeAndPassesOnTheSamePicture) {
  const std::string folder = shot_folder("golden", "[golden]\nframes = [1, 3]\n");
  const auto golden = [&](const std::string& more) {
    return run(fmt::format("softreel golden {0}/shot.toml --output {0}/out --quiet {1}", folder, more));
  };
  const Outcome missing = golden("");
  EXPECT_EQ(missing.status, 1);
  const std::string none = fmt::format("no golden images yet in {}/golden; --update makes them", folder);
  EXPECT_NE(missing.err.find(none), std::string::npos) << missing.err;
  EXPECT_EQ(missing.err.find("changed"), std::string::npos) << missing.err;
  EXPECT_EQ(missing.err.find("--update"), missing.err.rfind("--update")) << "said more than once: " << missing.err;
  EXPECT_EQ(golden("--update").status, 0);
  EXPECT_TRUE(exists(folder + "/golden/ball.0003.png"));
  EXPECT_EQ(golden("").status, 0);
  const Outcome changed = golden("--set 'material.soft.base_color=[0.1,0.9,0.1]'");
  EXPECT_EQ(changed.status, 1);
  EXPECT_NE(changed.err.find("block"), std::string::npos) << changed.err;
  EXPECT_TRUE(exists(folder + "/out/ball.0003.difference.png"));
  const Outcome resized = golden("--set render.width=32");
  EXPECT_EQ(resized.status, 1);
  EXPECT_NE(resized.err.find("32 x 36"), std::string::npos) << resized.err;
}

/// Vertex lines of an OBJ file as numbers.
std::vector<double> obj_numbers(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("v ")) continue;
    std::istringstream words(line.substr(2));
    for (std::string word; words >> word;) numbers.push_back(std::stod(word));
  }
  return numbers;
}

/// The positions of one sample of a PC2 file.
std::vector<float> pc2_sample(const std::string& bytes, std::size_t sample) {
  std::uint32_t points = 0;
  std::memcpy(&points, bytes.data() + 16, 4);
  std::vector<float> values(3 * points);
  std::memcpy(values.data(), bytes.data() + 32 + sample * values.size() * 4, values.size() * 4);
  return values;
}

TEST(Export, TheRestFrameIsTheFileItselfAndFormatsAgree) {
  const std::string folder = shot_folder("export");
  for (const char* format : {"obj", "pc2", "ply"})
    ASSERT_EQ(
        run(fmt::format("softreel export {0}/shot.toml --output {0}/out --quiet --format {1}", folder, format)).status,
        0);
  const std::string file = read_text(folder + "/sphere.obj");
  const std::string rest = read_text(folder + "/out/ball.ball.0001.obj");
  EXPECT_EQ(obj_numbers(rest), obj_numbers(file));
  const auto count = [](const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count(rest, "\nf "), count(file, "\nf ")) << "polygons were not kept";
  const std::vector<double> moved = obj_numbers(read_text(folder + "/out/ball.ball.0004.obj"));
  EXPECT_NE(moved, obj_numbers(file));
  const std::string pc2 = read_text(folder + "/out/ball.ball.pc2");
  EXPECT_EQ(pc2.substr(0, 12), std::string("POINTCACHE2\0", 12));
  const std::vector<float> last = pc2_sample(pc2, 3);
  ASSERT_EQ(last.size(), moved.size());
  for (std::size_t i = 0; i < moved.size(); ++i) EXPECT_EQ(last[i], static_cast<float>(moved[i])) << i;
}

TEST(Export, PinnedPointsStayAndWorldSpaceIsThePlacedOne) {
  const std::string folder = shot_folder("world", "");
  ASSERT_EQ(
      run(fmt::format("softreel export {0}/shot.toml --output {0}/out --quiet --space world --set body.fit=2", folder))
          .status,
      0);
  const std::vector<double> rest = obj_numbers(read_text(folder + "/out/ball.ball.0001.obj"));
  const std::vector<double> last = obj_numbers(read_text(folder + "/out/ball.ball.0004.obj"));
  double highest = 0;
  for (std::size_t i = 1; i < rest.size(); i += 3) {
    highest = std::max(highest, rest[i]);
    if (rest[i] > 0.4 - 1e-9) continue;  // the pin holds the lowest fifth
    for (std::size_t k = i - 1; k <= i + 1; ++k) EXPECT_NEAR(last[k], rest[k], 1e-12);
  }
  EXPECT_NEAR(highest, 2.0, 1e-12);
}

TEST(Preview, DrawsEveryFrameOrSaysWhyNot) {
  const std::string folder = shot_folder("preview");
  const Outcome outcome = run(fmt::format("softreel preview {0}/shot.toml --output {0}/out --frames 1-2", folder));
  if (has_no_egl(outcome)) GTEST_SKIP() << outcome.err;
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(exists(folder + "/out/ball.preview.0001.png"));
  EXPECT_TRUE(exists(folder + "/out/ball.preview.0002.png"));
}

TEST(DryRun, SaysWhatWouldBeDoneAndWritesNothing) {
  const std::string folder = shot_folder("dry");
  const Outcome outcome = run(fmt::format("softreel render {0}/shot.toml --output {0}/out --dry-run", folder));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part : {"700 tetrahedra", "64 x 36", "memory", "time"})
    EXPECT_NE(outcome.out.find(part), std::string::npos) << part << "\n" << outcome.out;
  EXPECT_FALSE(exists(folder + "/out"));
}

TEST(DryRun, CountsWhatIsStored) {
  const std::string folder = shot_folder("dry_stored");
  const auto plan = [&](const std::string& more) {
    return run(fmt::format("softreel render {0}/shot.toml --output {0}/out --dry-run {1}", folder, more)).out;
  };
  EXPECT_NE(plan("").find("simulate 4 of 4"), std::string::npos) << plan("");
  run(fmt::format("softreel render {0}/shot.toml --output {0}/out --quiet --frames 1-3", folder));
  EXPECT_NE(plan("").find("simulate 1 of 4"), std::string::npos) << plan("");
  EXPECT_NE(plan("").find("trace 1 of 4"), std::string::npos) << plan("");
  EXPECT_NE(plan("--set camera.azimuth_deg=3").find("trace 4 of 4"), std::string::npos);
  EXPECT_NE(plan("--frames 2 --set camera.azimuth_deg=3").find("simulate 0 of 2"), std::string::npos);
}

TEST(DryRun, CountsNoStoredPictureWhosePixelsAreGone) {
  const std::string folder = shot_folder("dry_gone");
  const std::string command = fmt::format("softreel render {0}/shot.toml --output {0}/out ", folder);
  ASSERT_EQ(run(command + "--quiet").status, 0);
  run(fmt::format("rm {0}/out/*.png", folder));
  EXPECT_NE(run(command + "--dry-run").out.find("trace 0 of 4"), std::string::npos);
  run(fmt::format("rm {0}/out/.cache/2/files/*", folder));
  EXPECT_NE(run(command + "--dry-run").out.find("trace 4 of 4"), std::string::npos);
}

TEST(DryRun, ExpectsTheMemoryOfPicturesThatAreShownAndOfTheMovie) {
  const std::string folder = shot_folder("dry_memory");
  write_text(folder + "/sky.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 8192\n");
  const auto bytes = [&](const std::string& more) {
    const Outcome outcome =
        run(fmt::format("softreel render {0}/shot.toml --output {0}/out --dry-run --json --set render.width=1920 --set "
                        "render.height=1080 {1}",
                        folder, more));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out)["expected"]["bytes"].get<double>();
  };
  EXPECT_NEAR(bytes(fmt::format("--set environment.image={}/sky.hdr", folder)) - bytes(""), 0.53e9, 0.2e9);
  EXPECT_NEAR(bytes("--set output.movie=true") - bytes(""), 0.45e9, 0.2e9);
}

TEST(Check, CountsTheSelectedPoints) {
  const std::string folder = shot_folder("check");
  const Outcome outcome = run(fmt::format("softreel check {0}/shot.toml", folder));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("body.ball.pull[0]"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("4 points"), std::string::npos) << outcome.out;
}

TEST(Inspect, CountsWhatTheFileHolds) {
  const std::string folder = shot_folder("inspect");
  const Outcome outcome = run(fmt::format("softreel inspect {0}/sphere.obj --json", folder));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json facts = json::parse(outcome.out);
  EXPECT_EQ(facts["vertices"], 2 + 11 * 24);
  EXPECT_EQ(facts["triangles"], 2 * 24 + 2 * 10 * 24);
  EXPECT_EQ(facts["boundary_edges"], 0);
  EXPECT_EQ(facts["pieces"], 1);
}

TEST(Tetrahedralize, WritesElementsWithinTheirBounds) {
  const std::string folder = shot_folder("tets");
  for (const char* extension : {"vtu", "msh", "mesh"}) {
    const Outcome outcome = run(fmt::format(
        "softreel tetrahedralize {0}/sphere.obj -o {0}/out.{1} --tets 3000 --quiet --json", folder, extension));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json report = json::parse(outcome.out);
    EXPECT_NEAR(report["tets"].get<double>(), 3000, 150);
    EXPECT_GE(report["min_dihedral_deg"].get<double>(), 10.2);
    EXPECT_LE(report["max_dihedral_deg"].get<double>(), 164.8);
    EXPECT_TRUE(exists(fmt::format("{}/out.{}", folder, extension)));
    const Outcome inspected = run(fmt::format("softreel inspect {}/out.{} --json", folder, extension));
    ASSERT_EQ(inspected.status, 0) << inspected.err;
    const json facts = json::parse(inspected.out);
    for (const char* fact : {"tets", "nodes", "volume", "min_dihedral_deg", "max_dihedral_deg"})
      EXPECT_EQ(facts[fact], report[fact]) << fact;
    EXPECT_EQ(facts["pieces"], 1);
  }
}

TEST(Tetrahedralize, EmbedsInWholeLatticeTetrahedra) {
  const std::string folder = shot_folder("tets_embedded");
  const std::string command =
      fmt::format("softreel tetrahedralize {0}/sphere.obj -o {0}/out.vtu --tets 3000 --mode embedded --quiet", folder);
  const Outcome outcome = run(command + " --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_NEAR(report["tets"].get<double>(), 3000, 150);
  EXPECT_NEAR(report["min_dihedral_deg"].get<double>(), 60, 1e-3);
  EXPECT_NEAR(report["max_dihedral_deg"].get<double>(), 90, 1e-3);
  EXPECT_LT(report["filled_share"].get<double>(), 1);
  EXPECT_GT(report["cut_cells"].get<int>(), 100);
  EXPECT_EQ(report["copies"].get<int>(), 0);
  const Outcome text = run(command);
  ASSERT_EQ(text.status, 0) << text.err;
  for (const char* part : {"filled to", "cut cells", "copies"})
    EXPECT_NE(text.out.find(part), std::string::npos) << text.out;
}

TEST(Inspect, RefusesBrokenTetrahedra) {
  const std::string folder = new_folder("tets_broken");
  write_text(folder + "/broken.mesh", "MeshVersionFormatted 2\nVertices\n3\n0 0 0 0\n");
  const Outcome outcome = run(fmt::format("softreel inspect {}/broken.mesh", folder));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("broken.mesh (byte "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("Accepted"), std::string::npos) << outcome.err;
}

TEST(Tetrahedralize, OptimizesWhatItFillsAndWhatItIsGiven) {
  const std::string folder = shot_folder("tets_optimize");
  const auto tetrahedralize = [&](const std::string& arguments) {
    const Outcome outcome = run(fmt::format("softreel tetrahedralize {0}/{1} --json", folder, arguments));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return std::pair(json::parse(outcome.out), outcome.err);
  };
  const json plain = tetrahedralize(fmt::format("sphere.obj -o {}/plain.msh --tets 9000", folder)).first;
  const auto [filled, said] = tetrahedralize(fmt::format("sphere.obj -o {}/filled.vtu --tets 9000 --optimize", folder));
  for (const char* part : {"dihedral angles", "became", "moved", "flipped"})
    EXPECT_NE(said.find(part), std::string::npos) << said;
  const json copied = tetrahedralize(fmt::format("plain.msh -o {}/copied.mesh", folder)).first;
  const json given = tetrahedralize(fmt::format("plain.msh -o {}/given.vtu --optimize", folder)).first;
  for (const char* fact : {"tets", "nodes", "volume", "min_dihedral_deg", "max_dihedral_deg"})
    EXPECT_EQ(copied[fact], plain[fact]) << fact;
  EXPECT_FALSE(given.contains("distance"));
  for (const json& better : {filled, given}) {
    EXPECT_GT(better["min_dihedral_deg"], plain["min_dihedral_deg"]);
    EXPECT_LE(better["max_dihedral_deg"], plain["max_dihedral_deg"]);
    EXPECT_NEAR(better["volume"].get<double>(), plain["volume"].get<double>(), 1e-3 * plain["volume"].get<double>());
  }
  EXPECT_LE(filled["distance"].get<double>(), 1.002 * plain["distance"].get<double>());
}

TEST(Tetrahedralize, RefusesSizesForGivenTetrahedra) {
  const std::string folder = shot_folder("tets_given");
  ASSERT_EQ(run(fmt::format("softreel tetrahedralize {0}/sphere.obj -o {0}/given.msh --tets 500", folder)).status, 0);
  for (const char* option : {"--edge 0.1", "--tets 500", "--error 1%", "--thickness 0.1", "--fit 2"}) {
    const Outcome outcome =
        run(fmt::format("softreel tetrahedralize {0}/given.msh -o {0}/out.vtu {1}", folder, option));
    EXPECT_EQ(outcome.status, 2);
    const std::string name = std::string(option).substr(0, std::string(option).find(' '));
    for (const std::string& part : {name, std::string("given.msh"), std::string("Accepted"), std::string("--optimize")})
      EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_FALSE(exists(folder + "/out.vtu"));
  }
}

TEST(Tetrahedralize, KeepsToAnErrorBudgetInPercentOrInTheMeshsUnit) {
  const std::string folder = shot_folder("tets_error");
  for (const char* budget : {"1%", "0.03"}) {
    const Outcome outcome = run(fmt::format(
        "softreel tetrahedralize {0}/sphere.obj -o {0}/out.vtu --error {1} --quiet --json", folder, budget));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json report = json::parse(outcome.out);
    if (budget[1] == '%')
      EXPECT_LE(report["distance_share_of_diagonal"].get<double>(), 0.01);
    else
      EXPECT_LE(report["distance"].get<double>(), 0.03);
    EXPECT_GT(report["tets"].get<double>(), 100);
  }
}

}  // namespace
}  // namespace softreel
