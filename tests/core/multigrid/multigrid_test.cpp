#include "core/multigrid/multigrid.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using test_support::assemble;
using test_support::at_left_end;
using test_support::ElasticParams;
using test_support::ElasticSystem;
using test_support::make_box;

struct Solution {
  SolveReport report;
  std::vector<Vec3> x;
};

Solution solve(const TetMesh& mesh, const ElasticSystem& system, double tolerance = 1e-8,
               const MultigridParams& params = {}, std::span<const double> stiffness = {}, int threads_count = 1) {
  const Threads threads(threads_count);
  Multigrid multigrid(mesh, stiffness, system.matrix.pattern, params, threads);
  multigrid.update(system.matrix, system.pinned);
  Solution solution;
  solution.x.assign(mesh.nodes.size(), Vec3::Zero());
  solution.report = multigrid.solve(system.matrix, system.load, solution.x, tolerance, 0, 400);
  return solution;
}

int iterations_to(const TetMesh& mesh, const ElasticParams& params, double tolerance = 1e-6) {
  const ElasticSystem system = assemble(mesh, params, at_left_end);
  const Solution solution = solve(mesh, system, tolerance);
  EXPECT_EQ(solution.report.status, SolveStatus::Converged);
  EXPECT_FALSE(solution.report.double_cycle);
  EXPECT_LE(test_support::relative_residual(system.matrix, system.load, solution.x), 1.01 * tolerance);
  return solution.report.iterations;
}

TEST(Multigrid, AgreesWithADirectSolver) {
  const TetMesh mesh = make_box({12, 3, 3}, 0.1);
  for (const double seconds : {0.0, 0.01}) {
    ElasticParams params;
    params.seconds = seconds;
    const ElasticSystem system = assemble(mesh, params, at_left_end);
    const Solution solution = solve(mesh, system, 1e-12);
    EXPECT_TRUE(solution.report.ok());
    Eigen::VectorXd load(3 * mesh.nodes.size());
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) load.segment<3>(3 * static_cast<Index>(i)) = system.load[i];
    const Eigen::VectorXd exact = test_support::solve(test_support::dense(system.matrix), load);
    double error = 0;
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
      error += (solution.x[i] - exact.segment<3>(3 * static_cast<Index>(i))).squaredNorm();
    EXPECT_LE(std::sqrt(error), 1e-8 * exact.norm());
  }
}

TEST(Multigrid, TakesNoMoreIterationsOnFinerMeshes) {
  for (const double nu : {0.3, 0.45})
    for (const double seconds : {0.0, 1.0 / 96}) {
      ElasticParams params;
      params.poisson_ratio = nu;
      params.seconds = seconds;
      const int coarse = iterations_to(test_support::make_bar(4), params);
      const int fine = iterations_to(test_support::make_bar(8), params);
      EXPECT_LE(coarse, 16) << "nu " << nu << ", step " << seconds;
      EXPECT_LE(fine, coarse + 3) << "nu " << nu << ", step " << seconds;
    }
}

TEST(Multigrid, ChoosesSweepsAndCycleByTheBody) {
  const std::vector<double> mild{1, 1, 5}, strong{1, 100, 1}, huge{1, 1e6, 1};
  MultigridParams params;
  EXPECT_EQ(choose_for_body(params, {}).sweeps, 1);
  EXPECT_EQ(choose_for_body(params, {}).coarse_cycle, CycleKind::W);
  EXPECT_EQ(choose_for_body(params, mild).coarse_cycle, CycleKind::W);
  EXPECT_EQ(choose_for_body(params, strong).coarse_cycle, CycleKind::FullW);
  EXPECT_EQ(choose_for_body(params, strong).sweeps, 1);
  EXPECT_EQ(choose_for_body(params, huge).sweeps, 1);
  params.poisson_ratio = 0.45;
  EXPECT_EQ(choose_for_body(params, {}).sweeps, 1);
  params.poisson_ratio = 0.49;
  EXPECT_EQ(choose_for_body(params, {}).sweeps, 2);
  EXPECT_EQ(choose_for_body(params, {}).coarse_cycle, CycleKind::W);
  params.smoother = SmootherKind::OneWayGaussSeidel;
  EXPECT_EQ(choose_for_body(params, {}).sweeps, 1) << "the paper's 1 + 1";
  params.sweeps = 3;
  params.coarse_cycle = CycleKind::V;
  EXPECT_EQ(choose_for_body(params, huge).sweeps, 3);
  EXPECT_EQ(choose_for_body(params, huge).coarse_cycle, CycleKind::V);
}

TEST(Multigrid, TakesAFewTimesTheIterationsNearIncompressibilityIfNotTold) {
  ElasticParams params;
  params.poisson_ratio = 0.3;
  const TetMesh mesh = test_support::make_bar(5);
  const int compressible = iterations_to(mesh, params);
  params.poisson_ratio = 0.49;
  EXPECT_LE(iterations_to(mesh, params), 4 * compressible);
}

TEST(Multigrid, TakesAboutAsManyIterationsAtAnyAspect) {
  const int cube = iterations_to(make_box({6, 6, 6}, 0.1), {});
  for (const Index aspect : {3, 10})
    EXPECT_LE(iterations_to(make_box({4 * aspect, 4, 4}, 0.1), {}), cube + 6) << "aspect " << aspect;
}

TEST(Multigrid, CopesWithAStiffnessContrastOfAMillion) {
  const TetMesh mesh = make_box({12, 6, 6}, 0.1);
  std::vector<double> factor, stiffness;
  for (const Tet& tet : mesh.tets) {
    Vec3 center = Vec3::Zero();
    for (const Index node : tet) center += 0.25 * mesh.nodes[static_cast<std::size_t>(node)];
    factor.push_back((center - Vec3(0.6, 0.3, 0.3)).norm() < 0.17 ? 1e6 : 1);
    stiffness.push_back(1e6 * factor.back());
  }
  const ElasticSystem plain = assemble(mesh, {}, at_left_end);
  const ElasticSystem stiff = assemble(mesh, {}, at_left_end, factor);
  const int homogeneous = solve(mesh, plain, 1e-6).report.iterations;
  const Solution solution = solve(mesh, stiff, 1e-6, {}, stiffness);
  EXPECT_TRUE(solution.report.ok());
  EXPECT_LE(solution.report.iterations, 2 * homogeneous);
}

TEST(Multigrid, CopesWithHardInclusionsThatNearlyTouch) {
  // Rows of hard cubes with one soft cube between: soft elements join hard nodes of different inclusions.
  const TetMesh mesh = make_box({12, 6, 6}, 0.1);
  std::vector<double> factor, stiffness;
  for (const Tet& tet : mesh.tets) {
    Vec3 center = Vec3::Zero();
    for (const Index node : tet) center += 2.5 * mesh.nodes[static_cast<std::size_t>(node)];
    const auto inside = [](double x) { return std::fmod(x, 4.0) < 3.0; };
    factor.push_back(inside(center[0]) && inside(center[1]) && inside(center[2]) ? 1e4 : 1);
    stiffness.push_back(1e6 * factor.back());
  }
  const ElasticSystem system = assemble(mesh, {}, at_left_end, factor);
  const int copied = solve(mesh, system, 1e-6, {}, stiffness).report.iterations;
  EXPECT_LE(copied, 30);
  EXPECT_LT(copied, solve(mesh, system, 1e-6).report.iterations);
}

TEST(Multigrid, SolvesTwoLegsThatPassTheSameCoarseNodes) {
  // Two legs one cube apart, joined at the top, standing on the ground.
  const TetMesh mesh = make_box({5, 4, 16}, 0.05, [](Index x, Index, Index z) { return x != 2 || z > 12; });
  const ElasticSystem system = assemble(mesh, {}, [](const Vec3& x) { return x[2] < 1e-9; });
  const Solution solution = solve(mesh, system, 1e-6);
  EXPECT_EQ(solution.report.status, SolveStatus::Converged);
  EXPECT_LE(solution.report.iterations, 20);
}

TEST(Multigrid, LeavesPinnedNodesExactlyAtZero) {
  const TetMesh mesh = make_box({10, 4, 4}, 0.1);
  const ElasticSystem system = assemble(mesh, {}, [](const Vec3& x) { return x[0] < 0.11 || x.norm() > 1.05; });
  const Solution solution = solve(mesh, system);
  EXPECT_TRUE(solution.report.ok());
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) EXPECT_EQ(solution.x[i].isZero(0), system.pinned[i] != 0) << i;
}

TEST(Multigrid, HasTheSameBitsWithOneAndFourThreads) {
  const TetMesh mesh = test_support::make_bar(5);
  const ElasticSystem system = assemble(mesh, {}, at_left_end);
  const Solution one = solve(mesh, system, 1e-8, {}, {}, 1), four = solve(mesh, system, 1e-8, {}, {}, 4);
  EXPECT_EQ(one.report.iterations, four.report.iterations);
  EXPECT_EQ(one.report.residual, four.report.residual);
  EXPECT_EQ(one.x, four.x);
}

TEST(Multigrid, UpdatedEqualsAFreshOneBitForBit) {
  const TetMesh mesh = make_box({10, 4, 4}, 0.1);
  ElasticParams other;
  other.poisson_ratio = 0.2;
  const ElasticSystem first = assemble(mesh, other, {}), second = assemble(mesh, {}, at_left_end);
  const Threads threads(1);
  Multigrid multigrid(mesh, {}, second.matrix.pattern, {}, threads);
  std::vector<Vec3> x(mesh.nodes.size(), Vec3::Zero());
  multigrid.update(first.matrix, first.pinned);
  multigrid.solve(first.matrix, first.load, x, 1e-3, 0, 10);
  multigrid.update(second.matrix, second.pinned);
  std::fill(x.begin(), x.end(), Vec3::Zero());
  multigrid.solve(second.matrix, second.load, x, 1e-8, 0, 400);
  EXPECT_EQ(x, solve(mesh, second).x);
}

TEST(Multigrid, ConvergesWithEveryGalerkinMethodAndCycle) {
  const TetMesh mesh = make_box({16, 6, 6}, 0.1);
  const ElasticSystem system = assemble(mesh, {}, at_left_end);
  const int reference = solve(mesh, system).report.iterations;
  for (const GalerkinMethod method : {GalerkinMethod::Naive, GalerkinMethod::Stream, GalerkinMethod::Gather})
    for (const CycleKind kind : {CycleKind::V, CycleKind::W}) {
      MultigridParams params;
      params.galerkin = method;
      params.coarse_cycle = kind;
      params.bottom_nodes = 50;
      const Solution solution = solve(mesh, system, 1e-8, params);
      EXPECT_EQ(solution.report.status, SolveStatus::Converged);
      EXPECT_LE(solution.report.iterations, reference + 4);
    }
}

TEST(Multigrid, TwoSweepsTakeFewerIterations) {
  const TetMesh mesh = test_support::make_bar(5);
  ElasticParams soft;
  soft.poisson_ratio = 0.49;
  const ElasticSystem system = assemble(mesh, soft, at_left_end);
  MultigridParams twice;
  twice.sweeps = 2;
  EXPECT_LT(solve(mesh, system, 1e-8, twice).report.iterations, solve(mesh, system, 1e-8).report.iterations);
}

TEST(Multigrid, ConvergesUnderScrambledElementRotations) {
  const TetMesh mesh = make_box({12, 4, 4}, 0.1);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Mat3> rotations;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    rotations.push_back(
        Quaternion(normal(random), normal(random), normal(random), normal(random)).normalized().toRotationMatrix());
  ElasticParams params;
  params.seconds = 1.0 / 24;
  const ElasticSystem system = assemble(mesh, params, at_left_end, {}, rotations);
  const Solution solution = solve(mesh, system);
  EXPECT_EQ(solution.report.status, SolveStatus::Converged);
  EXPECT_LE(solution.report.iterations, 60);
}

TEST(Multigrid, ConvergesOnAMeshWithoutALattice) {
  TetMesh mesh = make_box({12, 5, 5}, 0.1);
  for (Vec3& x : mesh.nodes) x += 0.01 * Vec3(std::sin(40 * x[1]), std::cos(50 * x[2]), std::sin(60 * x[0]));
  mesh.lattice = {};
  const ElasticSystem system = assemble(mesh, {}, [](const Vec3& x) { return x[0] < 0.02; });
  const Solution solution = solve(mesh, system, 1e-6);
  EXPECT_EQ(solution.report.status, SolveStatus::Converged);
  EXPECT_LE(solution.report.iterations, 30);
}

TEST(Multigrid, MovesAFreeBodyAsAWhole) {
  // Nothing holds the body: one implicit step under gravity gives every node g dt^2.
  const TetMesh mesh = make_box({9, 5, 5}, 0.1);
  ElasticParams params;
  params.seconds = 0.02;
  const ElasticSystem system = assemble(mesh, params, {});
  const Solution solution = solve(mesh, system, 1e-10);
  EXPECT_TRUE(solution.report.ok());
  for (const Vec3& u : solution.x) EXPECT_LE((u - Vec3(0, -9.81 * 0.02 * 0.02, 0)).norm(), 1e-9);
}

TEST(Multigrid, SolvesOneTetrahedron) {
  TetMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {{0, 1, 2, 3}};
  mesh.lattice.spacing = 1;
  for (const bool clamped : {true, false}) {
    ElasticParams params;
    params.seconds = clamped ? 0 : 0.1;
    const ElasticSystem system = assemble(mesh, params, [&](const Vec3& x) { return clamped && x[1] < 0.5; });
    MultigridParams tiny;
    for (const int bottom : {150, 1}) {
      tiny.bottom_nodes = bottom;
      const Solution solution = solve(mesh, system, 1e-10, tiny);
      EXPECT_TRUE(solution.report.ok());
      EXPECT_LE(test_support::relative_residual(system.matrix, system.load, solution.x), 1e-9);
    }
  }
}

TEST(Multigrid, SolvesWhenEveryNodeIsPinned) {
  const TetMesh mesh = make_box({8, 4, 4}, 0.1);
  ElasticSystem system = assemble(mesh, {}, [](const Vec3&) { return true; });
  system.load.assign(mesh.nodes.size(), Vec3(1, 2, 3));
  const Solution solution = solve(mesh, system, 1e-12);
  EXPECT_TRUE(solution.report.ok());
  const double diagonal = system.matrix.block(0)[0];
  for (const Vec3& u : solution.x) EXPECT_LE((u * diagonal - Vec3(1, 2, 3)).norm(), 1e-10);
}

TEST(Multigrid, SolvesSeparatePieces) {
  const TetMesh mesh = make_box({13, 5, 5}, 1.0, [](Index x, Index y, Index z) { return x % 2 + y % 2 + z % 2 == 0; });
  ElasticParams params;
  params.seconds = 0.01;
  const Solution solution = solve(mesh, assemble(mesh, params, at_left_end));
  EXPECT_EQ(solution.report.status, SolveStatus::Converged);
}

TEST(Multigrid, GoesOverToDoubleWhereFloatCannotBeDefinite) {
  // A slender rod bends so easily that its softest energy drowns in the rounding of float.
  const TetMesh mesh = make_box({400, 1, 1}, 0.01);
  const ElasticSystem system = assemble(mesh, {}, at_left_end);
  MultigridParams params;
  params.bottom_nodes = 40;
  const Solution solution = solve(mesh, system, 1e-6, params);
  EXPECT_TRUE(solution.report.ok());
  EXPECT_TRUE(solution.report.double_cycle);
}

TEST(Multigrid, SaysWhenRoundOffAllowsNoSmallerResidual) {
  const TetMesh mesh = make_box({8, 3, 3}, 0.1);
  const ElasticSystem system = assemble(mesh, {}, at_left_end);
  const Solution solution = solve(mesh, system, 1e-30);
  EXPECT_EQ(solution.report.status, SolveStatus::RoundOff);
  EXPECT_LE(solution.report.residual, 1e-9);
  EXPECT_LE(solution.report.iterations, 100);
}

TEST(Multigrid, StopsAtTheIterationLimit) {
  const TetMesh mesh = make_box({12, 5, 5}, 0.1);
  const ElasticSystem system = assemble(mesh, {}, at_left_end);
  const Threads threads(1);
  Multigrid multigrid(mesh, {}, system.matrix.pattern, {}, threads);
  multigrid.update(system.matrix, system.pinned);
  std::vector<Vec3> x(mesh.nodes.size(), Vec3::Zero());
  const SolveReport report = multigrid.solve(system.matrix, system.load, x, 1e-10, 0, 3);
  EXPECT_EQ(report.status, SolveStatus::MaxIterations);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_NEAR(report.residual, test_support::relative_residual(system.matrix, system.load, x), 1e-9);
}

TEST(Multigrid, ContinuesFromAGivenStart) {
  const TetMesh mesh = make_box({12, 5, 5}, 0.1);
  const ElasticSystem system = assemble(mesh, {}, at_left_end);
  const Threads threads(1);
  Multigrid multigrid(mesh, {}, system.matrix.pattern, {}, threads);
  multigrid.update(system.matrix, system.pinned);
  std::vector<Vec3> x = solve(mesh, system, 1e-9).x;
  EXPECT_EQ(multigrid.solve(system.matrix, system.load, x, 1e-6, 0, 100).iterations, 0);
  EXPECT_LE(multigrid.solve(system.matrix, system.load, x, 1e-10, 0, 100).iterations, 4);
}

TEST(Multigrid, AnswersAZeroLoadWithZero) {
  const TetMesh mesh = make_box({5, 3, 3}, 0.1);
  const ElasticSystem system = assemble(mesh, {}, at_left_end);
  const Threads threads(1);
  Multigrid multigrid(mesh, {}, system.matrix.pattern, {}, threads);
  multigrid.update(system.matrix, system.pinned);
  std::vector<Vec3> x(mesh.nodes.size(), Vec3(1, 2, 3)), zero(mesh.nodes.size(), Vec3::Zero());
  EXPECT_EQ(multigrid.solve(system.matrix, zero, x, 1e-6, 0, 100).status, SolveStatus::Converged);
  EXPECT_EQ(x, zero);
}

TEST(Multigrid, ReportsBreakdownOfWhatIsNotPositiveDefinite) {
  const TetMesh mesh = make_box({8, 4, 4}, 0.1);
  for (const double bad : {std::nan(""), -1e9}) {
    ElasticSystem system = assemble(mesh, {}, at_left_end);
    system.matrix.block(system.matrix.pattern.find(100, 100))[0] = bad;
    EXPECT_EQ(solve(mesh, system).report.status, SolveStatus::Breakdown) << bad;
  }
}

TEST(Multigrid, StaysAPreconditionerForANearbyMatrix) {
  const TetMesh mesh = make_box({12, 4, 4}, 0.1);
  ElasticParams softer;
  softer.youngs_modulus = 0.7e6;
  const ElasticSystem old = assemble(mesh, {}, at_left_end), present = assemble(mesh, softer, at_left_end);
  const Threads threads(1);
  Multigrid multigrid(mesh, {}, old.matrix.pattern, {}, threads);
  multigrid.update(old.matrix, old.pinned);
  std::vector<Vec3> x(mesh.nodes.size(), Vec3::Zero());
  const SolveReport report = multigrid.solve(present.matrix, present.load, x, 1e-8, 0, 100);
  EXPECT_EQ(report.status, SolveStatus::Converged);
  EXPECT_LE(test_support::relative_residual(present.matrix, present.load, x), 1.01e-8);
}

TEST(Multigrid, KeepsItsIterationsUnderTinyAndHugeUnits) {
  const TetMesh mesh = make_box({12, 4, 4}, 0.1);
  const int reference = iterations_to(mesh, {});
  for (const double scale : {1e-12, 1e12}) {
    ElasticParams params;
    params.youngs_modulus = 1e6 * scale;
    params.density = 1000 * scale * scale;
    EXPECT_EQ(iterations_to(mesh, params), reference);
  }
}

TEST(Multigrid, DescribesItsLevels) {
  const TetMesh mesh = make_box({12, 6, 6}, 0.1);
  const Threads threads(1);
  const Multigrid multigrid(mesh, {}, stiffness_pattern(mesh.tets, static_cast<Index>(mesh.nodes.size())), {}, threads);
  const std::vector<LevelInfo> levels = multigrid.levels();
  ASSERT_GE(levels.size(), 2u);
  EXPECT_EQ(levels[0].nodes, static_cast<Index>(mesh.nodes.size()));
  EXPECT_GT(levels[0].bytes, levels[0].blocks * 40);
  const std::string table = describe(levels);
  EXPECT_NE(table.find("nodes"), std::string::npos);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), static_cast<std::ptrdiff_t>(levels.size()) + 1);
}

}  // namespace
}  // namespace softreel
