// Meshes whose angles were improved: nodes are off their lattice and elements are flipped, and the hierarchy still
// fits.
#include <gtest/gtest.h>

#include "core/multigrid/multigrid.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/support/elastic_box.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

/// Iterations to 1e-6 of a mesh clamped where x < edge.
int iterations_of_step(const TetMesh& mesh, double seconds, double edge) {
  test_support::ElasticParams params;
  params.seconds = seconds;
  const test_support::ElasticSystem system =
      test_support::assemble(mesh, params, [&](const Vec3& x) { return x[0] < edge; });
  const Threads threads(1);
  Multigrid multigrid(mesh, {}, system.matrix.pattern, {}, threads);
  multigrid.update(system.matrix, system.pinned);
  std::vector<Vec3> x(mesh.nodes.size(), Vec3::Zero());
  const SolveReport report = multigrid.solve(system.matrix, system.load, x, 1e-6, 0, 400);
  EXPECT_EQ(report.status, SolveStatus::Converged);
  EXPECT_FALSE(report.double_cycle);
  return report.iterations;
}

TEST(OptimizedMesh, TakesNoMoreIterationsThanBefore) {
  const SurfaceMesh torus = test::make_torus(1, 0.35, 64, 32, Vec3::Zero());
  for (TetrahedralizeParams params : {TetrahedralizeParams{.tets = 12000}, TetrahedralizeParams{.error = 0.015}}) {
    const Threads threads(1);
    StageTimes times;
    const TetMesh plain = tetrahedralize(torus, params, "torus", threads, {}, times);
    params.optimize = true;
    const TetMesh optimized = tetrahedralize(torus, params, "torus", threads, {}, times);
    ASSERT_NE(optimized.nodes, plain.nodes);
    ASSERT_NE(optimized.tets, plain.tets);
    for (const double seconds : {0.0, 1.0 / 96})
      EXPECT_LE(iterations_of_step(optimized, seconds, -1.2), 1.1 * iterations_of_step(plain, seconds, -1.2) + 1);
  }
}

}  // namespace
}  // namespace softreel
