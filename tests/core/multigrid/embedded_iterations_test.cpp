// Iterations on embedded meshes, whose elements at the boundary are filled by any share down to 1e-6.
#include <vector>

#include <gtest/gtest.h>

#include "core/multigrid/multigrid.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/support/elastic_box.h"
#include "tests/support/surfaces.h"
#include "tests/support/thin_surfaces.h"

namespace softreel {
namespace {

using test_support::assemble;
using test_support::ElasticParams;
using test_support::ElasticSystem;

int iterations_of_filling(const SurfaceMesh& surface, TetMode mode, double edge, double seconds, double pinned_below) {
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
  return report.iterations;
}

constexpr double kEmbeddedSteps[] = {0.0, 1.0 / 96};

/// From the first lattice to finer ones, by a third at most.
void expect_no_growth(const SurfaceMesh& surface, const std::vector<double>& edges, double pinned_below) {
  for (const double seconds : kEmbeddedSteps) {
    const int coarse = iterations_of_filling(surface, TetMode::Embedded, edges.front(), seconds, pinned_below);
    for (const double edge : edges)
      EXPECT_LE(iterations_of_filling(surface, TetMode::Embedded, edge, seconds, pinned_below), 1.3 * coarse + 1)
          << "edge " << edge << ", step " << seconds;
  }
}

TEST(EmbeddedIterations, OfABallDoNotGrowWithItsSize) {
  expect_no_growth(test::make_sphere(1, 24, Vec3(0.03, 0.02, 0.01)), {0.25, 0.15, 0.1}, -0.7);
}

TEST(EmbeddedIterations, OfFingersSideBySideInOneCellDoNotGrowWithTheirSize) {
  expect_no_growth(test::make_fork(3, 0.05, 0.01), {0.3, 0.2, 0.1}, 0.4);
}

TEST(EmbeddedIterations, OfABarAreThoseOfAConformingOneWithinAHalf) {
  const SurfaceMesh bar = test::make_box({0.5, 0.125, 0.125}, 8, Vec3::Zero());
  for (const double seconds : kEmbeddedSteps)
    for (const double edge : {0.06, 0.03})
      EXPECT_LE(iterations_of_filling(bar, TetMode::Embedded, edge, seconds, -0.45),
                1.5 * iterations_of_filling(bar, TetMode::Conforming, edge, seconds, -0.45));
}

}  // namespace
}  // namespace softreel
