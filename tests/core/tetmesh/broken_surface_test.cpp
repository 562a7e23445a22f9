// What modellers and scanners deliver: filled with good tetrahedra, or refused in one line.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/mesh/mesh_repair.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/support/broken_surfaces.h"
#include "tests/support/tet_checks.h"

namespace softreel {
namespace {

class BrokenSurfaces : public ::testing::TestWithParam<test::BrokenSurface> {};

TetMesh fill(const test::BrokenSurface& broken, std::vector<std::string>& lines, int threads) {
  SurfaceMesh mesh = broken.mesh();
  lines = repair_mesh(mesh);
  const auto collect = [&](const std::string& line) { lines.push_back(line); };
  StageTimes times;
  return tetrahedralize(mesh, {.edge = broken.edge, .thickness = broken.thickness}, "blob", Threads(threads),
                        {collect, collect}, times);
}

TEST_P(BrokenSurfaces, AreFilledOrRefused) {
  const test::BrokenSurface& broken = GetParam();
  std::vector<std::string> lines;
  if (!broken.refusal.empty()) {
    try {
      fill(broken, lines, 1);
      FAIL() << "was filled";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      EXPECT_NE(std::string(error.what()).find(broken.refusal), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
    return;
  }
  const TetMesh mesh = fill(broken, lines, 1);
  test::expect_good_tets(mesh);
  test::expect_manifold_boundary(mesh);
  EXPECT_EQ(test::count_pieces(mesh), broken.pieces);
  const double volume = measure_quality(mesh, Threads(1)).volume;
  EXPECT_NEAR(volume / broken.volume, 1, broken.tolerance) << (lines.empty() ? "nothing said" : lines.back());
  EXPECT_EQ(fill(broken, lines, 3).nodes, mesh.nodes);
}

INSTANTIATE_TEST_SUITE_P(Zoo, BrokenSurfaces, ::testing::ValuesIn(test::broken_surfaces()),
                         [](const auto& surface) { return surface.param.name; });

}  // namespace
}  // namespace softreel
