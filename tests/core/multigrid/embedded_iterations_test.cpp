// Iterations on embedded meshes, whose elements at the boundary are filled by any share down to 1e-6.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "core/multigrid/multigrid.h"
#include "core/tetmesh/tetrahedralize.h"
#include "tests/support/elastic_box.h"
#include "tests/support/surfaces.h"
#include "tests/support/thin_surfaces.h"

namespace softreel {
namespace {

using test_support::assemble;
using test_support::ElasticParams;
using test_support::ElasticSystem;

int iterations(const SurfaceMesh& surface, TetMode mode, double edge, double seconds, double pinned_below) {
  const Threads threads(1);
  StageTimes times;
  const TetMesh mesh = tetrahedralize(surface, {.edge = edge, .mode = mode}, "test", threads, {}, times);
  ElasticParams elastic;
  elastic.seconds = seconds;
  elastic.poisson_ratio = 0.3;
  const ElasticSystem system = assemble(mesh, elastic, [&](const Vec3& x) { return x.x() < pinned_below; });
  MultigridParams params;
  params.poisson_ratio = 0.3;
  Multigrid multigrid(mesh, {}, system.matrix.pattern, params, threads);
  multigrid.update(system.matrix, system.pinned);
  std::vector<Vec3> x(mesh.nodes.size(), Vec3::Zero());
  const SolveReport report = multigrid.solve(system.matrix, system.load, x, 1e-6, 0, 1000);
  EXPECT_EQ(report.status, SolveStatus::Converged);
  EXPECT_LE(test_support::relative_residual(system.matrix, system.load, x), 1.01e-6);
  std::printf("edge %g, %zu tets, step %g, mode %d: %d iterations\n", edge, mesh.tets.size(), seconds,
              static_cast<int>(mode), report.iterations);
  return report.iterations;
}

constexpr double kSteps[] = {0.0, 1.0 / 96};

TEST(EmbeddedIterations, OfABallDoNotGrowWithItsSize) {
  const SurfaceMesh ball = test::make_sphere(1, 24, Vec3(0.03, 0.02, 0.01));
  for (const double seconds : kSteps) {
    const int small = iterations(ball, TetMode::Embedded, 0.25, seconds, -0.7);
    for (const double edge : {0.15, 0.1})
      EXPECT_LE(iterations(ball, TetMode::Embedded, edge, seconds, -0.7), 1.3 * small + 1);
  }
}

TEST(EmbeddedIterations, OfABarAreThoseOfAConformingOneWithinAHalf) {
  const SurfaceMesh bar = test::make_box({0.5, 0.125, 0.125}, 8, Vec3::Zero());
  for (const double seconds : kSteps)
    for (const double edge : {0.06, 0.03})
      EXPECT_LE(iterations(bar, TetMode::Embedded, edge, seconds, -0.45),
                1.5 * iterations(bar, TetMode::Conforming, edge, seconds, -0.45));
}

}  // namespace
}  // namespace softreel
