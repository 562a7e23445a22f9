/// What the program makes of files that are no mesh, of damaged ones and of large ones.
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

struct BadFile {
  const char* test;
  const char* name;
  std::string bytes;
  const char* says;
};

void PrintTo(const BadFile& file, std::ostream* out) {
  *out << file.name;
}

class BadFiles : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadFiles, AreRefusedInOneMessageAndLeaveNothing) {
  const BadFile& file = GetParam();
  const std::string folder = new_folder("bad_file");
  const std::string path = fmt::format("{}/{}", folder, file.name);
  write_text(path, file.bytes);
  const Outcome outcome = run(fmt::format("softreel tetrahedralize {0} -o {1}/out.vtu", path, folder));
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.find("\nsoftreel: "), outcome.err.rfind("softreel: ") - 1) << "two messages: " << outcome.err;
  EXPECT_NE(outcome.err.find(file.name), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(file.says), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("Accepted: "), std::string::npos) << outcome.err;
  for (const char c : outcome.err) EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= ' ') << outcome.err;
  EXPECT_EQ(files_under(folder), std::vector<std::string>({file.name}));
}

const std::string kText = "It was a dark and stormy night;\nthe rain fell in torrents\n";
const std::string kSphere = sphere_obj(6);

const BadFile kBadFiles[] = {
    {"TextAsObj", "a.obj", kText, "no vertex and no face"},
    {"TextAsPly", "a.ply", kText, "a.ply:1:"},
    {"TextAsStl", "a.stl", kText, "no STL file"},
    {"TextAsOff", "a.off", kText, "a.off:1:"},
    {"TextAsFbx", "a.fbx", kText, "cannot be read"},
    {"TextWithoutEnding", "notes", kText, "no reader knows this format"},
    {"UnknownEnding", "a.xyzzy", kText, "no reader knows this format"},
    {"Empty", "a.obj", "", "empty"},
    {"EmptyFbx", "a.fbx", "", "empty"},
    {"CutOffFace", "a.obj", kSphere.substr(0, kSphere.size() * 2 / 3) + "/", "a.obj:"},
    {"CutOffHeader", "a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 8\nprop", "a.ply:4:"},
    {"CutOffData", "a.ply",
     "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0",
     "ends before"},
    {"CountsBeyondTheFile", "a.off", "OFF\n2000000000 2000000000 0\n0 0 0\n", "ends before"},
    {"ControlBytes", "a.obj", "v 0 0 \x1b[31m\x07\n", "'?[31m?'"},
    {"PointsOnly", "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "3 vertices but no face"},
    {"Flat", "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "flat"},
    {"OnePlace", "a.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "no triangles"},
    {"NoNumbers", "a.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"},
    {"Tetrahedra", "a.vtu", "<VTKFile/>", "a VTK file of another kind"},
};

INSTANTIATE_TEST_SUITE_P(Program, BadFiles, ::testing::ValuesIn(kBadFiles),
                         [](const auto& file) { return std::string(file.param.test); });

TEST(BadFiles, AFolderIsOne) {
  const std::string folder = new_folder("bad_folder");
  const Outcome outcome = run(fmt::format("softreel tetrahedralize {0} -o {0}/out.vtu", folder));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("this is a folder"), std::string::npos) << outcome.err;
}

TEST(Lengths, ThatAreNoNumbersAboveZeroAreRefused) {
  const std::string folder = shot_folder("lengths");
  for (const char* option : {"--edge", "--thickness", "--fit"})
    for (const char* value : {"nan", "inf", "0", "-1", "1x"}) {
      const Outcome outcome =
          run(fmt::format("softreel tetrahedralize {0}/sphere.obj -o {0}/out.vtu {1} {2}", folder, option, value));
      EXPECT_EQ(outcome.status, 2) << option << ' ' << value;
      EXPECT_NE(outcome.err.find(fmt::format("{}: {} is no length", option, value)), std::string::npos) << outcome.err;
    }
}

TEST(Names, ThatAreNoUtf8DoNotStopJson) {
  const std::string folder = new_folder("latin");
  write_text(folder + "/a.obj", "g T\xfcr\n" + sphere_obj(6));
  const Outcome outcome = run(fmt::format("softreel inspect {}/a.obj --json", folder));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out)["groups"][0]["name"], "T\xef\xbf\xbdr");
}

TEST(Repairs, AreOneLineEach) {
  const std::string folder = new_folder("repairs");
  // Face 1 again, face 2 turned, a face of two places, a face of a vertex without numbers.
  std::string mesh = sphere_obj(6) + "v nan 0 0\nf 1 2 3\nf 1 2 1\nf 63 1 2\n";
  const auto second = mesh.find("f 1 3 4\n");
  ASSERT_NE(second, std::string::npos);
  mesh.replace(second, 8, "f 1 4 3\n");
  write_text(folder + "/a.obj", mesh);
  const Outcome outcome = run(fmt::format("softreel tetrahedralize {0}/a.obj -o {0}/out.vtu --tets 2000", folder));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::vector<std::string> lines;
  std::istringstream said(outcome.err);
  for (std::string line; std::getline(said, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 4U) << outcome.err;
  EXPECT_NE(lines[0].find("1 of"), std::string::npos) << lines[0];
  EXPECT_NE(lines[1].find("two corners in one place"), std::string::npos) << lines[1];
  EXPECT_NE(lines[2].find("1 duplicate"), std::string::npos) << lines[2];
  EXPECT_NE(lines[3].find("turned to agree"), std::string::npos) << lines[3];
}

TEST(AMillionTriangles, AreFilledInGoodTime) {
  const std::string folder = new_folder("million");
  write_text(folder + "/a.obj", sphere_obj(501));  // 2 * 500 * 1002 triangles
  // Of processor time, so that a busy machine fails nothing.
  const Outcome outcome =
      run(fmt::format("ulimit -t 120; softreel tetrahedralize {0}/a.obj -o {0}/out.vtu --tets 100000 --json", folder));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_NEAR(report["tets"].get<double>(), 1e5, 5e3);
  EXPECT_NEAR(report["volume"].get<double>(), 3.14159265 / 6, 0.01 * 3.14159265 / 6);
  EXPECT_LT(report["distance_share_of_diagonal"].get<double>(), 0.01);
}

}  // namespace
}  // namespace softreel
