#include "core/tetmesh/error_budget.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/tetmesh/graded_stuffing.h"
#include "core/tetmesh/tetrahedralize.h"
#include "tests/support/surfaces.h"
#include "tests/support/tet_checks.h"
#include "tests/support/tiny_mesh_reader.h"

namespace softreel {
namespace {

/// Fills within `error`; collects what was said.
TetMesh fill(const SurfaceMesh& surface, double error, std::vector<std::string>& lines, int threads = 1) {
  const auto collect = [&](const std::string& line) { lines.push_back(line); };
  StageTimes times;
  return tetrahedralize(surface, {.error = error}, "blob", Threads(threads), {collect, collect}, times);
}

void expect_good_graded(const TetMesh& mesh) {
  const TetQuality quality = measure_quality(mesh, Threads(1));
  EXPECT_GT(quality.min_volume, 0);
  EXPECT_GE(quality.min_dihedral, kMinGradedDihedral);
  EXPECT_LE(quality.max_dihedral, kMaxGradedDihedral);
  test::expect_manifold_boundary(mesh);
}

/// A ball with a thin spike along x: the spike asks for smaller leaves than the ball.
SurfaceMesh spiked_ball() {
  SurfaceMesh mesh = test::make_sphere(1, 60, Vec3::Zero());
  for (Vec3& p : mesh.positions) {
    const double across = std::hypot(p.y(), p.z());
    if (p.x() > 0 && across < 0.12) p.x() += 12 * (0.12 - across);
  }
  return mesh;
}

TEST(FillToError, KeepsToItsBudgetOnSmoothSharpAndThinSurfaces) {
  struct Case {
    const char* name;
    SurfaceMesh surface;
    int euler;
  };
  for (const auto& [name, surface, euler] :
       {Case{"sphere", test::make_sphere(1, 40, Vec3::Zero()), 2},
        Case{"torus", test::make_torus(1, 0.35, 64, 32, Vec3(0.1, 0.2, 0.3)), 0},
        Case{"box", test::make_box({1, 0.6, 0.4}, 4, Vec3::Zero()), 2}, Case{"spiked ball", spiked_ball(), 2}}) {
    SCOPED_TRACE(name);
    std::vector<std::string> lines;
    const double error = 0.006 * used_bounds(surface).diagonal();
    const TetMesh mesh = fill(surface, error, lines);
    EXPECT_LE(measure_deviation(surface, mesh, Threads(1)).two_way(), error);
    expect_good_graded(mesh);
    EXPECT_EQ(test::euler_characteristic(mesh), euler);
    EXPECT_EQ(test::count_pieces(mesh), 1);
    EXPECT_TRUE(lines.empty()) << lines.front();
  }
}

TEST(FillToError, IsFineAtASpikeAndCoarseInside) {
  std::vector<std::string> lines;
  const SurfaceMesh surface = spiked_ball();
  const TetMesh mesh = fill(surface, 0.02, lines);
  double in_spike = 0, in_ball = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    const Vec3 center = (mesh.nodes[static_cast<std::size_t>(a)] + mesh.nodes[static_cast<std::size_t>(b)] +
                         mesh.nodes[static_cast<std::size_t>(c)] + mesh.nodes[static_cast<std::size_t>(d)]) /
                        4;
    const double volume = tet_volume(mesh.nodes[static_cast<std::size_t>(a)], mesh.nodes[static_cast<std::size_t>(b)],
                                     mesh.nodes[static_cast<std::size_t>(c)], mesh.nodes[static_cast<std::size_t>(d)]);
    if (center.x() > 1.5) in_spike = std::max(in_spike, volume);
    if (center.norm() < 0.4) in_ball = std::max(in_ball, volume);
  }
  EXPECT_GT(in_spike, 0);
  EXPECT_GT(in_ball, 8 * in_spike);
}

TEST(FillToError, SaysWhatItCannotReach) {
  // A blade as thin as a hundredth of the budget's finest edge.
  SurfaceMesh surface = test::make_sphere(1, 20, Vec3::Zero());
  test::append(surface, test::make_box({1e-5, 0.3, 0.3}, 8, Vec3(1.1, 0, 0)));
  std::vector<std::string> lines;
  try {
    const TetMesh mesh = fill(surface, 0.03, lines);
    ASSERT_FALSE(lines.empty());
    EXPECT_NE(lines.back().find("error = 0.03 m"), std::string::npos) << lines.back();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    EXPECT_NE(std::string(error.what()).find("part 2 of 2"), std::string::npos) << error.what();
  }
}

TEST(FillToError, GivesEqualBitsAtOneAndFourThreads) {
  std::vector<std::string> lines;
  const SurfaceMesh surface = spiked_ball();
  const TetMesh one = fill(surface, 0.02, lines), four = fill(surface, 0.02, lines, 4);
  EXPECT_EQ(one.nodes, four.nodes);
  EXPECT_EQ(one.tets, four.tets);
}

TEST(FillToError, ReachesASharedMeshWithFewTetrahedra) {
  const std::string path = std::string(SOFTREEL_SOURCE_DIR) + "/../shared/meshes/spot.obj";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const SurfaceMesh surface = test::read_tiny_mesh(path);
  std::vector<std::string> lines;
  const double error = 0.003 * used_bounds(surface).diagonal();
  const TetMesh mesh = fill(surface, error, lines);
  EXPECT_LE(measure_deviation(surface, mesh, Threads(1)).two_way(), error);
  EXPECT_LT(mesh.tets.size(), 80000U);
  expect_good_graded(mesh);
}

}  // namespace
}  // namespace softreel
