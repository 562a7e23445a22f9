/// `softreel new`: every mesh gives a shot that is sound and renders as it is.
#include <cmath>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
namespace fs = std::filesystem;

/// Two frames as small and quick as can be.
constexpr const char* kQuick =
    "--frames 1-2 --quiet --set render.width=48 --set render.height=27 --set render.samples=1 --set "
    "render.max_bounces=1";

TEST(NewShotCommands, SurviveAShell) {
  const std::string folder = new_folder("new words");
  const Outcome made =
      run(fmt::format("softreel new '{}/assets/pudding.ply' -o \"{}/it's.toml\"", SOFTREEL_SOURCE_DIR, folder));
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.out.find(fmt::format("softreel check '{}/it'\\''s.toml'", folder)), std::string::npos) << made.out;
  EXPECT_NE(read_text(folder + "/it's.toml").find("softreel check 'it'\\''s.toml'"), std::string::npos);
}

/// A mesh of the sources, or of Debian's assimp-testmodels.
class NewShot : public ::testing::TestWithParam<const char*> {};

TEST_P(NewShot, IsSoundAndRendersAsItIs) {
  const std::string given = GetParam();
  const std::string mesh = given.starts_with('/') ? given : SOFTREEL_SOURCE_DIR "/assets/" + given;
  if (!fs::exists(mesh)) GTEST_SKIP() << mesh << " is not there: package assimp-testmodels";
  const std::string folder = new_folder("new");
  const Outcome made = run(fmt::format("softreel new '{}' -o {}/shot.toml --tets 2500", mesh, folder));
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.out.find("Next: softreel check"), std::string::npos) << made.out;
  const Outcome checked = run(fmt::format("softreel check {}/shot.toml", folder));
  EXPECT_EQ(checked.status, 0) << checked.err;
  const Outcome rendered = run(fmt::format("softreel render {0}/shot.toml --output {0}/out {1}", folder, kQuick));
  EXPECT_EQ(rendered.status, 0) << rendered.err;
  EXPECT_TRUE(exists(folder + "/out/shot.0001.png"));
  EXPECT_TRUE(exists(folder + "/out/shot.0002.png"));
}

constexpr const char* kMeshes[] = {"creature.ply",
                                   "colt.ply",
                                   "octopus.ply",
                                   "pudding.ply",
                                   "bar.ply",
                                   "/usr/share/assimp/models/OBJ/box.obj",
                                   "/usr/share/assimp/models/OBJ/concave_polygon.obj",
                                   "/usr/share/assimp/models/STL/sphereWithHole.stl",
                                   "/usr/share/assimp/models/OFF/Cube.off",
                                   "/usr/share/assimp/models/Collada/duck.dae",
                                   "/usr/share/assimp/models/PLY/cube.ply",
                                   "/usr/share/assimp/models/STL/Spider_ascii.stl",
                                   "/usr/share/assimp/models/glTF2/BoxTextured-glTF/BoxTextured.gltf"};

INSTANTIATE_TEST_SUITE_P(Program, NewShot, ::testing::ValuesIn(kMeshes), [](const auto& mesh) {
  std::string name = fs::path(mesh.param).filename().string();
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
});

/// Positions of an OBJ file's vertices.
std::vector<std::array<double, 3>> positions_of(const std::string& file) {
  std::vector<std::array<double, 3>> all;
  std::istringstream lines(read_text(file));
  for (std::string line; std::getline(lines, line);) {
    std::array<double, 3> p{};
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3) all.push_back(p);
  }
  return all;
}

TEST(NewShots, HoldTheBaseAndMoveTheTop) {
  const std::string folder = new_folder("new_motion");
  write_text(folder + "/sphere.obj", sphere_obj(12));
  ASSERT_EQ(run(fmt::format("cd {}; softreel new sphere.obj --tets 700 --quiet", folder)).status, 0);
  const Outcome moved =
      run(fmt::format("cd {}; softreel export sphere.toml --frames 1-26 --output out --quiet --space world", folder));
  ASSERT_EQ(moved.status, 0) << moved.err;
  const auto before = positions_of(folder + "/sphere.obj"),
             after = positions_of(folder + "/out/sphere.sphere.0026.obj");
  ASSERT_EQ(before.size(), after.size());
  double top = 0;
  for (std::size_t v = 0; v < before.size(); ++v) {
    double way = 0;
    for (std::size_t k = 0; k < 3; ++k) way += std::pow(after[v][k] - before[v][k], 2);
    way = std::sqrt(way);
    if (before[v][1] < 0.02) {
      EXPECT_LT(way, 1e-9) << "held point " << v;
    }
    if (before[v][1] > 0.98) top = std::max(top, way);
  }
  EXPECT_GT(top, 0.1) << "the pull is too weak to be seen";
  EXPECT_LT(top, 0.6) << "the pull tears the body apart";
}

TEST(NewShots, AreNotWrittenOverThoseThatAreThere) {
  const std::string folder = new_folder("new_twice");
  write_text(folder + "/sphere.obj", sphere_obj(6));
  write_text(folder + "/sphere.toml", "mine\n");
  const std::string command = fmt::format("cd {}; softreel new sphere.obj --tets 300", folder);
  const Outcome refused = run(command);
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
  EXPECT_EQ(read_text(folder + "/sphere.toml"), "mine\n");
  EXPECT_EQ(run(command + " --force").status, 0);
  EXPECT_NE(read_text(folder + "/sphere.toml").find("[body.sphere]"), std::string::npos);
}

TEST(NewShots, WrittenBehindALinkFindTheirMesh) {
  const std::string folder = new_folder("new_link");
  write_text(folder + "/sphere.obj", sphere_obj(6));
  std::filesystem::create_directories(folder + "/far/deep");
  std::filesystem::create_directory_symlink("far/deep", folder + "/link");
  const Outcome made = run(fmt::format("cd {}; softreel new sphere.obj --tets 300 -o link/sphere.toml", folder));
  ASSERT_EQ(made.status, 0) << made.err;
  const Outcome checked = run(fmt::format("softreel check {}/link/sphere.toml", folder));
  EXPECT_EQ(checked.status, 0) << checked.err;
}

TEST(NewShots, TakeAMaterialAndTheLookOfAPreset) {
  const std::string folder = new_folder("new_like");
  write_text(folder + "/sphere.obj", sphere_obj(8));
  const std::string start = fmt::format("cd {}; softreel new sphere.obj -o - --tets 300 ", folder);
  const Outcome jelly = run(start + "--material jelly");
  EXPECT_EQ(jelly.status, 0) << jelly.err;
  EXPECT_NE(jelly.out.find("[material.jelly]"), std::string::npos);
  // Its material wants colours of the vertices, which this mesh has not.
  const Outcome like =
      run(fmt::format("cd {}; softreel new sphere.obj --tets 300 --like daylight -o like.toml", folder));
  EXPECT_EQ(like.status, 0) << like.err;
  EXPECT_NE(like.out.find("left out"), std::string::npos) << like.out;
  const Outcome rendered = run(fmt::format("cd {}; softreel render like.toml --output out {}", folder, kQuick));
  EXPECT_EQ(rendered.status, 0) << rendered.err;
  EXPECT_NE(read_text(folder + "/like.toml").find("[environment.sky]"), std::string::npos);
  const Outcome unknown = run(start + "--material jely");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("Did you mean jelly?"), std::string::npos) << unknown.err;
  EXPECT_EQ(run(start + "--like nothing").status, 2);
  EXPECT_EQ(run(start + "--pin soles").status, 2) << "the mesh has no such group";
}

TEST(NewShots, SayThatEdgesAreHardWhereTheMeshHasSuch) {
  const std::string folder = new_folder("new_hard");
  write_text(folder + "/cube.obj",
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
             "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  write_text(folder + "/sphere.obj", sphere_obj(12));
  for (const char* name : {"cube", "sphere"}) {
    const Outcome made = run(fmt::format("cd {}; softreel new {}.obj -o - --tets 300", folder, name));
    ASSERT_EQ(made.status, 0) << made.err;
    const bool hard = std::string(name) == "cube";
    EXPECT_EQ(made.out.find("\ncrease_deg = 40") != std::string::npos, hard) << made.out;
    EXPECT_EQ(made.out.find("edges sharper than this") != std::string::npos, hard) << made.out;
  }
}

TEST(NewShots, OfWhatEnclosesNoVolumeAreRefused) {
  const std::string folder = new_folder("new_flat");
  write_text(folder + "/line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  for (const char* mesh : {"line.obj", "none.obj"}) {
    const Outcome refused = run(fmt::format("cd {}; softreel new {}", folder, mesh));
    EXPECT_EQ(refused.status, 2) << mesh;
    EXPECT_NE(refused.err.find(mesh), std::string::npos) << refused.err;
    EXPECT_FALSE(exists(folder + "/line.toml"));
  }
}

}  // namespace
}  // namespace softreel
