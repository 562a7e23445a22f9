// Iterations of conjugate gradients over sizes, aspects, Poisson's ratios and stiffness contrasts: what holds of the
// wish for 20 % and a factor of two (the benchmark iteration_counts measures more and larger ones).
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/multigrid/multigrid.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using test_support::assemble;
using test_support::at_left_end;
using test_support::ElasticParams;
using test_support::ElasticSystem;

constexpr double kSteps[] = {0.0, 1.0 / 96};

/// A bar 0.25 m wide of `across` cubes.
TetMesh bar(Index aspect, Index across) {
  return test_support::make_box({aspect * across, across, across}, 0.25 / across);
}

int iterations(const TetMesh& mesh, double poisson_ratio, double seconds, MultigridParams params = {},
               const std::vector<double>& factor = {}) {
  params.poisson_ratio = poisson_ratio;
  ElasticParams elastic;
  elastic.poisson_ratio = poisson_ratio;
  elastic.seconds = seconds;
  const ElasticSystem system = assemble(mesh, elastic, at_left_end, factor);
  const Threads threads(1);
  Multigrid multigrid(mesh, factor, system.matrix.pattern, params, threads);
  multigrid.update(system.matrix, system.pinned);
  std::vector<Vec3> x(mesh.nodes.size(), Vec3::Zero());
  const SolveReport report = multigrid.solve(system.matrix, system.load, x, 1e-6, 0, 1000);
  EXPECT_EQ(report.status, SolveStatus::Converged);
  EXPECT_LE(test_support::relative_residual(system.matrix, system.load, x), 1.01e-6);
  return report.iterations;
}

TEST(IterationCounts, StayWithinAFifthFromElevenToAHundredThousandTetrahedra) {
  for (const double nu : {0.3, 0.45})
    for (const double seconds : kSteps) {
      const int small = iterations(bar(4, 6), nu, seconds), large = iterations(bar(4, 13), nu, seconds);
      EXPECT_LE(std::abs(large - small), std::max(1.0, 0.2 * small)) << "nu " << nu << ", step " << seconds;
    }
}

TEST(IterationCounts, StayWithinAFifthInStepsOfAnyAspect) {
  for (const double nu : {0.3, 0.45}) {
    const int reference = iterations(bar(4, 6), nu, 1.0 / 96);
    for (const Index aspect : {1, 20})
      EXPECT_LE(std::abs(iterations(bar(aspect, aspect == 1 ? 10 : 4), nu, 1.0 / 96) - reference), 0.2 * reference)
          << "nu " << nu << ", aspect " << aspect;
  }
}

TEST(IterationCounts, GrowByHalfAtMostInStaticsOfAnyAspect) {
  for (const double nu : {0.3, 0.45}) {
    const int reference = iterations(bar(4, 6), nu, 0);
    for (const Index aspect : {1, 20})
      EXPECT_LE(iterations(bar(aspect, aspect == 1 ? 10 : 4), nu, 0), 1.5 * reference)
          << "nu " << nu << ", aspect " << aspect;
  }
}

TEST(IterationCounts, AtMostDoubleNearIncompressibility) {
  for (const Index across : {6, 11})
    for (const double seconds : kSteps)
      EXPECT_LE(iterations(bar(4, across), 0.49, seconds), 2 * iterations(bar(4, across), 0.3, seconds));
}

TEST(IterationCounts, NearIncompressibilityTripleWithOneSweepAndHalveWithTwo) {
  const TetMesh mesh = bar(4, 6);
  MultigridParams once, twice;
  once.sweeps = 1;
  twice.sweeps = 2;
  for (const double seconds : kSteps) {
    const int one = iterations(mesh, 0.49, seconds, once), two = iterations(mesh, 0.49, seconds, twice);
    EXPECT_LE(one, 3.5 * iterations(mesh, 0.3, seconds));
    EXPECT_LE(two, 0.6 * one);
    EXPECT_EQ(two, iterations(mesh, 0.49, seconds)) << "the default takes two";
  }
}

/// 1e6 where `stiff` says so of an element and its centre, else 1.
template <typename Predicate>
std::vector<double> factors(const TetMesh& mesh, const Predicate& stiff) {
  std::vector<double> result;
  for (const Tet& tet : mesh.tets) {
    Vec3 center = Vec3::Zero();
    for (const Index node : tet) center += 0.25 * mesh.nodes[static_cast<std::size_t>(node)];
    result.push_back(stiff(center) ? 1e6 : 1.0);
  }
  return result;
}

std::vector<double> checkered(const TetMesh& mesh, double block_size) {
  const auto block = [block_size](double x) { return static_cast<int>(x / block_size); };
  return factors(mesh, [&](const Vec3& x) { return (block(x[0]) + block(x[1]) + block(x[2])) % 2 == 1; });
}

TEST(IterationCounts, AboutDoubleAtAMillionFoldContrastInBlocksThatTouchByEdgesAndLessWithTwoSweeps) {
  MultigridParams twice;
  twice.sweeps = 2;
  for (const Index across : {4, 6, 9}) {
    const TetMesh mesh = bar(4, across);
    const std::vector<double> factor = checkered(mesh, 0.125);
    for (const double seconds : kSteps) {
      const int reference = iterations(mesh, 0.3, seconds);
      EXPECT_LE(iterations(mesh, 0.3, seconds, {}, factor), 2.3 * reference) << across << " cubes, step " << seconds;
      EXPECT_LE(iterations(mesh, 0.3, seconds, twice, factor), 2 * reference) << across << " cubes, step " << seconds;
    }
  }
}

TEST(IterationCounts, OfBlocksFallByAQuarterWithAWFromTheFinestLevelOn) {
  const TetMesh mesh = bar(4, 6);
  const std::vector<double> factor = checkered(mesh, 0.125);
  MultigridParams w, full;
  w.sweeps = full.sweeps = 1;
  w.coarse_cycle = CycleKind::W;
  full.coarse_cycle = CycleKind::FullW;
  for (const double seconds : kSteps)
    EXPECT_LE(iterations(mesh, 0.3, seconds, full, factor), 0.75 * iterations(mesh, 0.3, seconds, w, factor));
}

TEST(IterationCounts, OfAHundredFoldContrastInRandomElementsStayWithinThreeFold) {
  // A million-fold contrast is a linkage of stiff tetrahedra hinged at nodes, whose soft mechanisms no coarse lattice
  // carries: that takes hundreds of iterations (see the benchmark).
  const TetMesh mesh = bar(4, 6);
  std::mt19937 random(7);
  std::vector<double> factor = factors(mesh, [&](const Vec3&) { return random() % 10 == 0; });
  for (double& f : factor) f = std::min(f, 100.0);
  MultigridParams no_copies;
  no_copies.stiffness_contrast = 1e9;
  // Copies of coarse nodes at so many contrasts nearly depend on each other, which the bottom has to bear.
  for (const double seconds : kSteps)
    for (const MultigridParams& params : {no_copies, MultigridParams()})
      EXPECT_LE(iterations(mesh, 0.3, seconds, params, factor), 3 * iterations(mesh, 0.3, seconds));
}

}  // namespace
}  // namespace softreel
