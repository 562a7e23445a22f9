// Exports through the built program: what the files of all formats say of one shot, what a second run keeps, and what
// is refused.
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/types.h"
#include "render/image/image_io.h"
#include "tests/support/program.h"
#include "tests/tool/export/readers/glb_reader.h"
#include "tests/tool/export/readers/point_cache_reader.h"
#include "tests/tool/export/readers/usda_reader.h"

namespace softreel::testing {
namespace {

/// Numbers behind a keyword ("v", "vn") of an OBJ file.
std::vector<double> obj_values(const std::string& path, const std::string& keyword) {
  std::istringstream text(read_text(path));
  std::vector<double> numbers;
  for (std::string line, word; std::getline(text, line);) {
    std::istringstream words(line);
    words >> word;
    if (word != keyword) continue;
    while (words >> word) numbers.push_back(std::stod(word));
  }
  return numbers;
}

std::vector<float> to_floats(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

void expect_same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(b[i])) << "number " << i;
}

/// Files written and kept, as the report says.
std::pair<int, int> written_and_kept(const Outcome& outcome) {
  const auto report = nlohmann::json::parse(outcome.out);
  return {report.at("files").at("written").get<int>(), report.at("files").at("kept").get<int>()};
}

/// A folder with a shot that is simulated once: exports of a case share its cache.
class ExportProgram : public ::testing::Test {
 protected:
  Outcome export_shot(const std::string& options) const {
    return run(fmt::format("softreel export {0}/shot.toml --output {0}/out --json --quiet {1}", folder_, options));
  }
  void require_export(const std::string& options) const {
    const Outcome outcome = export_shot(options);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }
  std::string file(const std::string& name) const { return folder_ + "/out/" + name; }
  std::string bytes(const std::string& name) const { return read_text(file(name)); }

  const std::string folder_ = shot_folder("exports");
};

TEST_F(ExportProgram, AllFormatsOfOneRunSayTheSamePositionsInFileOrder) {
  require_export("--format obj,pc2,mdd --format glb,usda");
  const PointCache pc2 = read_pc2(bytes("ball.ball.pc2")), mdd = read_mdd(bytes("ball.ball.mdd"));
  const GlbScene glb = read_glb(bytes("ball.ball.glb"));
  const auto usda = read_usda(bytes("ball.usda"));
  ASSERT_EQ(pc2.samples.size(), 4U);
  ASSERT_EQ(mdd.samples.size(), 4U);
  ASSERT_EQ(glb.times.size(), 4U);
  for (std::size_t s = 0; s < 4; ++s) {
    const std::vector<float> exact = to_floats(obj_values(file(fmt::format("ball.ball.000{}.obj", s + 1)), "v"));
    expect_same_bits(pc2.samples[s], exact);
    expect_same_bits(mdd.samples[s], exact);
    expect_same_bits(usda->child("ball/ball").property("points").samples.at(1.0 + static_cast<double>(s)).floats(),
                     exact);
    EXPECT_EQ(mdd.times[s], static_cast<float>((1.0 + static_cast<double>(s)) / 24));
    EXPECT_EQ(glb.times[s], static_cast<float>(static_cast<double>(s) / 24)) << "a clip begins at 0";
    const std::vector<float> shown = glb.positions_at(glb.times[s]);
    ASSERT_EQ(shown.size(), exact.size()) << "a mesh without texture coordinates needs no duplicates";
    for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(shown[i], exact[i], 1.2e-7);
  }
  expect_same_bits(glb.positions, to_floats(obj_values(folder_ + "/sphere.obj", "v")));
}

TEST_F(ExportProgram, ObjectSpaceWithItsPlacementIsWorldSpace) {
  const std::string placed =
      "--set body.ball.rotate_deg=[10,20,30] --set body.ball.translate=[0,0.5,-1] --set body.fit=2 ";
  require_export(placed + "--format glb");
  require_export(placed + "--format usda --unit cm --up z");
  const auto object = read_usda(bytes("ball.usda"));
  const GlbScene glb = read_glb(bytes("ball.ball.glb"));
  require_export(placed + "--format obj --space world");
  const std::vector<double> world = obj_values(file("ball.ball.0003.obj"), "v");
  const UsdPrim& mesh = object->child("ball/ball");
  const std::vector<double> rows = mesh.property("xformOp:transform").value.doubles();
  const std::vector<double> points = mesh.property("points").samples.at(3).doubles();
  ASSERT_EQ(points.size(), world.size());
  const std::vector<float> shown = glb.positions_at(glb.times[2]);
  const Quaternion turn(glb.rotation[3], glb.rotation[0], glb.rotation[1], glb.rotation[2]);
  for (std::size_t i = 0; i < points.size(); i += 3) {
    const Vec3 expected(world[i], world[i + 1], world[i + 2]);
    Vec3 by_usda;
    for (std::size_t k = 0; k < 3; ++k)
      by_usda[static_cast<Index>(k)] =
          points[i] * rows[k] + points[i + 1] * rows[4 + k] + points[i + 2] * rows[8 + k] + rows[12 + k];
    const Vec3 turned(expected.x(), -expected.z(), expected.y());
    EXPECT_NEAR((0.01 * by_usda - turned).norm(), 0, 1e-6);
    const Vec3 local = glb.scale[0] * Vec3(shown[i], shown[i + 1], shown[i + 2]);
    const Vec3 by_glb = turn * local + Vec3(glb.translation[0], glb.translation[1], glb.translation[2]);
    EXPECT_NEAR((by_glb - expected).norm(), 0, 1e-6);
  }
}

TEST_F(ExportProgram, UnitsAndAxesOfTheWorldAreThoseAskedFor) {
  require_export("--format obj --space world");
  const std::vector<double> meters = obj_values(file("ball.ball.0004.obj"), "v");
  require_export("--format obj --space world --unit in --up z");
  const std::vector<double> turned = obj_values(file("ball.ball.0004.obj"), "v");
  ASSERT_EQ(turned.size(), meters.size());
  for (std::size_t i = 0; i < meters.size(); i += 3) {
    EXPECT_NEAR(0.0254 * turned[i], meters[i], 1e-12);
    EXPECT_NEAR(0.0254 * turned[i + 1], -meters[i + 2], 1e-12);
    EXPECT_NEAR(0.0254 * turned[i + 2], meters[i + 1], 1e-12);
  }
  require_export("--format usda --unit cm");
  EXPECT_EQ(read_usda(bytes("ball.usda"))->metadata.at("metersPerUnit").number, 0.01);
}

TEST_F(ExportProgram, NormalsHaveUnitLengthAndPointOutwardsInEveryFormatThatHoldsThem) {
  require_export("--format obj,glb,usda --normals");
  const std::vector<double> positions = obj_values(file("ball.ball.0003.obj"), "v"),
                            normals = obj_values(file("ball.ball.0003.obj"), "vn");
  ASSERT_EQ(normals.size(), positions.size());
  const auto usda = read_usda(bytes("ball.usda"));
  expect_same_bits(usda->child("ball/ball").property("normals").samples.at(3).floats(), to_floats(normals));
  const GlbScene glb = read_glb(bytes("ball.ball.glb"));
  const std::vector<float> shown = glb.normals_at(glb.times[2]);
  ASSERT_EQ(shown.size(), normals.size());
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    const Vec3 n(normals[i], normals[i + 1], normals[i + 2]);
    EXPECT_NEAR(n.norm(), 1, 1e-12);
    EXPECT_GT(n.dot(Vec3(positions[i], positions[i + 1] - 0.5, positions[i + 2])), 0) << "the ball's middle";
    EXPECT_NEAR((Vec3(shown[i], shown[i + 1], shown[i + 2]) - n).norm(), 0, 1e-6);
  }
}

TEST_F(ExportProgram, SubFramesLieBetweenFramesThatStayAsTheyAre) {
  require_export("--format pc2 --set solver.substeps=4");
  const PointCache frames = read_pc2(bytes("ball.ball.pc2"));
  require_export("--format pc2,mdd,usda --subframes 3 --set solver.substeps=4");
  const PointCache fine = read_pc2(bytes("ball.ball.pc2")), mdd = read_mdd(bytes("ball.ball.mdd"));
  const auto usda = read_usda(bytes("ball.usda"));
  EXPECT_EQ(fine.frames_apart, 0.25F);
  ASSERT_EQ(fine.samples.size(), 13U);
  for (std::size_t f = 0; f < 4; ++f) expect_same_bits(fine.samples[4 * f], frames.samples[f]);
  double off_line = 0, step = 0;
  for (std::size_t s = 0; s < 13; ++s) {
    const double frame = 1 + 0.25 * static_cast<double>(s);
    EXPECT_EQ(mdd.times[s], static_cast<float>(frame / 24));
    expect_same_bits(mdd.samples[s], fine.samples[s]);
    expect_same_bits(usda->child("ball/ball").property("points").samples.at(frame).floats(), fine.samples[s]);
    if (s % 4 == 0) continue;
    const float share = 0.25F * static_cast<float>(s % 4);
    for (std::size_t i = 0; i < fine.samples[s].size(); ++i) {
      const float a = frames.samples[s / 4][i], b = frames.samples[s / 4 + 1][i];
      off_line = std::max<double>(off_line, std::abs(fine.samples[s][i] - ((1 - share) * a + share * b)));
      step = std::max<double>(step, std::abs(b - a));
    }
  }
  EXPECT_GT(off_line, 1e-4 * step) << "sub-frames are the solver's steps, not a blend of frames";
  EXPECT_LT(off_line, step);
}

TEST_F(ExportProgram, FilesOfSubFramesAreNamedSoThatTheySortByTime) {
  require_export("--format ply --frames 2-3 --subframes 1");
  for (const char* name : {"0002.000", "0002.500", "0003.000"})
    EXPECT_TRUE(exists(file(fmt::format("ball.ball.{}.ply", name)))) << name;
  EXPECT_FALSE(exists(file("ball.ball.0002.ply")));
}

TEST_F(ExportProgram, KeepsWhatIsDoneAndMakesWhatIsMissingOrOfOtherOptions) {
  const std::string all = "--format obj,pc2,glb,usda";
  EXPECT_EQ(written_and_kept(export_shot(all)), std::pair(7, 0));
  const std::string glb = bytes("ball.ball.glb"), usda = bytes("ball.usda");
  EXPECT_EQ(written_and_kept(export_shot(all)), std::pair(0, 7));
  std::filesystem::remove(file("ball.ball.0002.obj"));
  std::filesystem::remove(file("ball.ball.glb"));
  write_text(file("ball.usda"), usda.substr(0, usda.size() / 2));
  EXPECT_EQ(written_and_kept(export_shot(all)), std::pair(3, 4));
  EXPECT_TRUE(bytes("ball.ball.glb") == glb) << "another run, other bytes";
  EXPECT_TRUE(bytes("ball.usda") == usda) << "another run, other bytes";
  EXPECT_EQ(written_and_kept(export_shot("--format glb,usda --fps 30")), std::pair(2, 0));
  EXPECT_EQ(written_and_kept(export_shot("--format obj --normals")), std::pair(4, 0));
  EXPECT_EQ(written_and_kept(export_shot("--format usda --fps 30 --set camera.azimuth_deg=80")), std::pair(1, 0))
      << "the camera is in the file";
  EXPECT_EQ(written_and_kept(export_shot("--format glb --fps 30 --set camera.azimuth_deg=80")), std::pair(0, 1))
      << "and not in this one";
  EXPECT_EQ(written_and_kept(export_shot("--format glb --fps 30 --set material.soft.base_color=[1,0,0]")),
            std::pair(1, 0));
}

TEST_F(ExportProgram, ARangeOfFramesKeepsItsPlaceInTime) {
  require_export("--format pc2,mdd,glb,usda --frames 3-4");
  EXPECT_EQ(read_pc2(bytes("ball.ball.pc2")).start_frame, 3.0F);
  EXPECT_EQ(read_mdd(bytes("ball.ball.mdd")).times[0], 3.0F / 24);
  const GlbScene glb = read_glb(bytes("ball.ball.glb"));
  EXPECT_EQ(glb.times[0], 0) << "clips of players begin at once";
  EXPECT_NE(glb.header.find("\"first_frame\":3"), std::string::npos) << glb.header;
  EXPECT_EQ(read_usda(bytes("ball.usda"))->metadata.at("startTimeCode").number, 3);
}

TEST_F(ExportProgram, NeverTakesThePlaceOfWhatTheShotReads) {
  require_export("--format obj --frames 2");
  const std::string pose = bytes("ball.ball.0002.obj");
  const std::string as_mesh = fmt::format("--set 'body.ball.mesh=\"{}\"' ", file("ball.ball.0002.obj"));
  for (const char* formats : {"--format obj", "--format pc2,obj --frames 1-3"}) {
    const Outcome outcome = export_shot(as_mesh + formats);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_NE(outcome.err.find("ball.ball.0002.obj: the shot reads this file"), std::string::npos) << outcome.err;
    EXPECT_EQ(bytes("ball.ball.0002.obj"), pose);
    EXPECT_FALSE(exists(file("ball.ball.pc2"))) << "refused before the work";
  }
  EXPECT_EQ(export_shot(as_mesh + "--format obj --frames 3-4").status, 0) << "files beside it are free";
  // By way of a link to the file, or to the folder, too.
  std::filesystem::create_symlink(file("ball.ball.0002.obj"), folder_ + "/pose.obj");
  EXPECT_EQ(export_shot(fmt::format("--set 'body.ball.mesh=\"{}/pose.obj\"' --format obj", folder_)).status, 2);
  EXPECT_EQ(bytes("ball.ball.0002.obj"), pose);
  std::filesystem::create_directory_symlink(folder_ + "/out", folder_ + "/elsewhere");
  const Outcome linked = run(
      fmt::format("softreel export {0}/shot.toml --output {0}/elsewhere --quiet {1} --format obj", folder_, as_mesh));
  EXPECT_EQ(linked.status, 2) << linked.err;
  EXPECT_EQ(bytes("ball.ball.0002.obj"), pose);
}

TEST_F(ExportProgram, PathsOfPicturesFollowAFolderThatWasMoved) {
  const std::vector<std::uint8_t> png = encode_png({2, 2, std::vector<std::uint8_t>(12, 200)});
  write_text(folder_ + "/paint.png", std::string(png.begin(), png.end()));
  write_text(folder_ + "/mapped.obj",
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
             "f 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n");
  const std::string paint = fmt::format(
      "--set 'material.soft.base_color_texture=\"{0}/paint.png\"' --set 'body.ball.mesh=\"{0}/mapped.obj\"' --set "
      "body.ball.tets=2000",
      folder_);
  const auto to = [&](const std::string& folder) {
    return run(fmt::format("softreel export {0}/shot.toml --quiet --json --format usda --output {0}/{1} {2}", folder_,
                           folder, paint));
  };
  const Outcome first = to("moved");
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(written_and_kept(to("moved")), std::pair(0, 1));
  std::filesystem::create_directory(folder_ + "/deep");
  std::filesystem::rename(folder_ + "/moved", folder_ + "/deep/moved");
  EXPECT_EQ(written_and_kept(to("deep/moved")), std::pair(1, 0));
}

TEST_F(ExportProgram, ADryRunSaysWhichFilesAndNoPictures) {
  require_export("--format obj,pc2 --frames 1-2");
  const auto plan = nlohmann::json::parse(export_shot("--format obj,pc2 --frames 1-4 --dry-run").out);
  EXPECT_EQ(plan.at("files").at("missing"), 3) << "two poses, and the point cache of more frames";
  EXPECT_EQ(plan.at("files").at("of"), 5);
  EXPECT_EQ(plan.at("files").at("outdated"), 1);
  EXPECT_EQ(plan.at("simulate").at("missing"), 2);
  EXPECT_FALSE(plan.contains("trace"));
  EXPECT_EQ(plan.at("expected").at("render_seconds"), 0);
  EXPECT_FALSE(exists(file("ball.ball.0003.obj")));
  EXPECT_TRUE(nlohmann::json::parse(export_shot("--format obj --frames 1-2 --dry-run").out).at("complete").get<bool>());
}

TEST_F(ExportProgram, RefusesBeforeItWorksWhatAFormatCouldOnlyIgnore) {
  struct Refusal {
    std::string options;
    std::vector<std::string> words;
  };
  const std::vector<Refusal> refusals{
      {"--format pc2 --normals", {"--normals", "pc2 holds no normals"}},
      {"--format obj,glb --unit cm", {"--unit", "obj", "--space world"}},
      {"--format glb --space world --unit cm", {"--unit", "glb is in metres"}},
      {"--format obj --fps 25", {"--fps", "obj"}},
      {"--format usda --fps 0", {"--fps", "above 0"}},
      {"--format usda --subframes 100", {"--subframes"}},
      {"--format obj,gbl", {"gbl", "Did you mean glb?"}},
  };
  for (const Refusal& refusal : refusals) {
    const Outcome outcome = export_shot(refusal.options);
    EXPECT_EQ(outcome.status, 2) << refusal.options << outcome.err;
    for (const std::string& word : refusal.words)
      EXPECT_NE(outcome.err.find(word), std::string::npos) << "no \"" << word << "\" in: " << outcome.err;
  }
  EXPECT_FALSE(exists(folder_ + "/out")) << "something was made for nothing";
}

TEST(ExportOfTwoBodies, EachFileHoldsItsOwnBodyAndUsdaHoldsBoth) {
  const std::string folder =
      shot_folder("two",
                  "[body.\"side kick\"]\nmesh = \"sphere.obj\"\nfit = 0.5\ntets = 300\ntranslate = [2, 0, 0]\n"
                  "material = \"soft\"\n");
  const Outcome outcome = run(fmt::format(
      "softreel export {0}/shot.toml --output {0}/out --quiet --format obj,mdd,glb,usda --subframes 1", folder));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto usda = read_usda(read_text(folder + "/out/ball.usda"));
  for (const auto& [body, prim] : {std::pair("ball", "ball"), std::pair("side kick", "side_kick")}) {
    const std::string stem = fmt::format("{}/out/ball.{}", folder, body);
    const PointCache mdd = read_mdd(read_text(stem + ".mdd"));
    const GlbScene glb = read_glb(read_text(stem + ".glb"));
    ASSERT_EQ(mdd.samples.size(), 7U);
    for (std::size_t s = 0; s < 7; ++s) {
      const double frame = 1 + 0.5 * static_cast<double>(s);
      const std::string obj = fmt::format("{}.{:04}.{:03}.obj", stem, static_cast<int>(frame), 500 * (s % 2));
      const std::vector<float> exact = to_floats(obj_values(obj, "v"));
      expect_same_bits(mdd.samples[s], exact);
      expect_same_bits(usda->child(fmt::format("ball/{}", prim)).property("points").samples.at(frame).floats(), exact);
      const std::vector<float> shown = glb.positions_at(glb.times[s]);
      for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(shown[i], exact[i], 1.2e-7 * (1 + std::abs(exact[i])));
    }
  }
}

TEST_F(ExportProgram, OptionsMayStandBeforeTheShot) {
  const Outcome outcome =
      run(fmt::format("softreel export --format obj,ply --frames 1 {0}/shot.toml --output {0}/out --quiet", folder_));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(exists(file("ball.ball.0001.obj")));
  EXPECT_TRUE(exists(file("ball.ball.0001.ply")));
}

TEST_F(ExportProgram, TheCameraOfUsdaMovesWhereTheShotsDoesAndStaysOtherwise) {
  require_export("--format usda");
  const auto still = read_usda(bytes("ball.usda"));
  const UsdPrim& camera = still->child("ball/camera");
  EXPECT_NEAR(camera.property("focalLength").value.number, 0.5, 1e-7) << "50 mm in tenths of a metre";
  EXPECT_EQ(camera.property("xformOp:transform").value.doubles().size(), 16U);
  require_export("--format usda --set camera.focal_length_mm='[{frame=1,value=50},{frame=3,value=90}]'");
  const auto zoomed = read_usda(bytes("ball.usda"));
  const auto& lengths = zoomed->child("ball/camera").property("focalLength").samples;
  ASSERT_EQ(lengths.size(), 4U);
  EXPECT_NEAR(lengths.at(1).number, 0.5, 1e-7);
  EXPECT_NEAR(lengths.at(3).number, 0.9, 1e-7);
}

TEST_F(ExportProgram, WarnsOfWhatALookLosesAndWritesAgainWhereItChanged) {
  const Outcome lost = export_shot("--format glb --set material.soft.subsurface=0.5");
  ASSERT_EQ(lost.status, 0) << lost.err;
  EXPECT_NE(lost.err.find("left out of glb files"), std::string::npos) << lost.err;
  const Outcome glows = export_shot("--format glb --set material.soft.emission=[4,2,0]");
  EXPECT_EQ(written_and_kept(glows), std::pair(1, 0));
  EXPECT_EQ(glows.err.find("left out"), std::string::npos) << glows.err;
  EXPECT_NE(read_glb(bytes("ball.ball.glb")).header.find("emissiveStrength"), std::string::npos);
}

TEST_F(ExportProgram, WritesAgainWhatHasTheColoursOfVerticesWhereTheyChanged) {
  const std::string plain = read_text(folder_ + "/sphere.obj");
  const auto paint = [&](const std::string& color) {
    std::istringstream lines(plain);
    std::string text;
    for (std::string line; std::getline(lines, line);) text += line + (line.starts_with("v ") ? color : "") + "\n";
    write_text(folder_ + "/sphere.obj", text);
  };
  const std::string all = "--format obj,ply,glb,usda --set material.soft.vertex_colors=true";
  paint(" 1 0 0");
  const Outcome red = export_shot(all);
  ASSERT_EQ(red.status, 0) << red.err;
  EXPECT_EQ(red.err.find("left out"), std::string::npos) << red.err;
  EXPECT_EQ(written_and_kept(red), std::pair(10, 0)) << "four frames of obj and ply, two files of all";
  EXPECT_EQ(written_and_kept(export_shot(all)), std::pair(0, 10));
  paint(" 0 0 1");
  EXPECT_EQ(written_and_kept(export_shot(all)), std::pair(10, 0));
  const std::vector<float> glb = read_glb(bytes("ball.ball.glb")).colors;
  ASSERT_GE(glb.size(), 3U);
  EXPECT_EQ(std::vector<float>(glb.begin(), glb.begin() + 3), std::vector<float>({0, 0, 1}));
  const std::vector<double> obj = obj_values(file("ball.ball.0004.obj"), "v");
  EXPECT_EQ(std::vector<double>(obj.begin() + 3, obj.begin() + 6), std::vector<double>({0, 0, 1}));
  require_export("--format glb");
  paint(" 0 1 0");
  EXPECT_EQ(written_and_kept(export_shot("--format glb")), std::pair(0, 1)) << "it does not show them";
}

TEST(ExportHelp, NamesEveryFormatWithItsLine) {
  const Outcome help = run("softreel export --help");
  for (const char* line : {"obj: Wavefront", "ply: binary", "pc2: PC2", "mdd: MDD", "glb: binary glTF", "usda: USD"})
    EXPECT_NE(help.out.find(line), std::string::npos) << line;
}

}  // namespace
}  // namespace softreel::testing
