/// Exports of the tetrahedra and of level sets, by the program: files, options, and what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;

Outcome export_shot(const std::string& folder, const std::string& options) {
  return run(fmt::format("softreel export {0}/shot.toml --output {0}/out --quiet {1}", folder, options));
}

TEST(ExportTets, WritesAFileAFrameAndTheListThatParaViewOpensAndKeepsThemAll) {
  const std::string folder = shot_folder("export_vtu");
  ASSERT_EQ(export_shot(folder, "--format vtu --frames 1-2").status, 0);
  for (const char* file : {"ball.ball.0001.vtu", "ball.ball.0002.vtu", "ball.ball.pvd"})
    EXPECT_TRUE(exists(folder + "/out/" + file)) << file;
  const std::string first = read_text(folder + "/out/ball.ball.0002.vtu");
  for (const char* name : {"displacement", "strain", "green_strain", "cauchy_stress", "von_mises_stress", "material"})
    EXPECT_NE(first.find(fmt::format("Name=\"{}\"", name)), std::string::npos) << name;
  const Outcome again =
      run(fmt::format("softreel export {0}/shot.toml --output {0}/out --format vtu --frames 1-2 --json", folder));
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.out.find("\"written\": 0,\n  \"kept\": 3"), std::string::npos) << again.out;
}

TEST(ExportLevelSet, RefusesVoxelsOfOtherFormatsAndOfNoSize) {
  const std::string folder = shot_folder("export_voxel");
  const Outcome other = export_shot(folder, "--format pc2 --voxel 0.1");
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("--voxel: pc2 holds no voxels"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("with vdb"), std::string::npos) << other.err;
  EXPECT_EQ(export_shot(folder, "--format vdb --voxel 0").status, 2);
  EXPECT_EQ(export_shot(folder, "--format vdb --voxel -1").status, 2);
}

#if SOFTREEL_HAS_OPENVDB

TEST(ExportLevelSet, WritesAFileAFrameThatChangesWithTheVoxelOnly) {
  const std::string folder = shot_folder("export_vdb");
  ASSERT_EQ(export_shot(folder, "--format vdb --frames 1-2 --voxel 0.05").status, 0);
  const std::string coarse = read_text(folder + "/out/ball.ball.0001.vdb");
  EXPECT_EQ(coarse.substr(0, 4), " BDV") << "OpenVDB's magic number";
  ASSERT_EQ(export_shot(folder, "--format vdb --frames 1-2 --voxel 0.025").status, 0);
  const std::string fine = read_text(folder + "/out/ball.ball.0001.vdb");
  EXPECT_GT(fine.size(), coarse.size()) << "four times as many voxels, if nothing were packed";
  ASSERT_EQ(export_shot(folder, "--format vdb --frames 1-2 --voxel 0.05").status, 0);
  EXPECT_EQ(read_text(folder + "/out/ball.ball.0001.vdb"), coarse);
}

TEST(ExportLevelSet, RefusesMoreVoxelsThanAMachineHoldsAndSaysWhichEdgeFits) {
  const std::string folder = shot_folder("export_voxels");
  const Outcome tiny = export_shot(folder, "--format vdb --frames 1 --voxel 1e-6");
  EXPECT_EQ(tiny.status, 2);
  for (const char* part : {"--voxel: 1e-06", "body ball at frame 1", "Accepted: up to 5e+08, here a voxel of 0.0001"})
    EXPECT_NE(tiny.err.find(part), std::string::npos) << tiny.err;
}

TEST(ExportLevelSet, OfASurfaceWithAHoleIsRefusedByName) {
  const std::string folder = shot_folder("export_open");
  std::string obj = read_text(folder + "/sphere.obj");
  obj.erase(obj.rfind("f "));
  write_text(folder + "/sphere.obj", obj);
  const Outcome open = export_shot(folder, "--format vdb --frames 1");
  EXPECT_EQ(open.status, 2) << "the hole is closed for the tetrahedra only";
  for (const char* part : {"--format vdb", "body ball is not closed: 1 holes with 3 edges", "closed surfaces", "vtu"})
    EXPECT_NE(open.err.find(part), std::string::npos) << open.err;
  EXPECT_EQ(export_shot(folder, "--format vtu --frames 1").status, 0);
}

#else

TEST(ExportLevelSet, SaysThatThePartIsMissing) {
  const Outcome none = export_shot(shot_folder("export_no_vdb"), "--format vdb --frames 1");
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("SOFTREEL_WITH_OPENVDB"), std::string::npos) << none.err;
}

#endif

}  // namespace
}  // namespace softreel
