// The choices of method and smoother: all come to the same answer, with the same bits at any thread count.
#include <cmath>
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

struct Choice {
  const char* name;
  SolveMethod method;
  SmootherKind smoother;
  CycleKind cycle = CycleKind::W;
  int sweeps = 1;
};

constexpr Choice kChoices[] = {
    {"default", SolveMethod::ConjugateGradients, SmootherKind::GaussSeidel},
    {"one way", SolveMethod::ConjugateGradients, SmootherKind::OneWayGaussSeidel},
    {"chebyshev", SolveMethod::ConjugateGradients, SmootherKind::Chebyshev},
    {"full w", SolveMethod::ConjugateGradients, SmootherKind::GaussSeidel, CycleKind::FullW},
    {"two sweeps", SolveMethod::ConjugateGradients, SmootherKind::GaussSeidel, CycleKind::W, 2},
    {"full w of two sweeps, cycles", SolveMethod::Cycles, SmootherKind::GaussSeidel, CycleKind::FullW, 2},
    {"cycles", SolveMethod::Cycles, SmootherKind::GaussSeidel},
    {"the paper's cycles", SolveMethod::Cycles, SmootherKind::OneWayGaussSeidel, CycleKind::V},
    {"chebyshev cycles", SolveMethod::Cycles, SmootherKind::Chebyshev},
};

MultigridParams params_of(const Choice& choice) {
  MultigridParams params;
  params.method = choice.method;
  params.smoother = choice.smoother;
  params.coarse_cycle = choice.cycle;
  params.sweeps = choice.sweeps;
  params.bottom_nodes = 60;
  return params;
}

struct CycleSolution {
  SolveReport report;
  std::vector<Vec3> x;
};

CycleSolution solve(const TetMesh& mesh, const ElasticSystem& system, const MultigridParams& params, int thread_count) {
  const Threads threads(thread_count);
  Multigrid multigrid(mesh, {}, system.matrix.pattern, params, threads);
  multigrid.update(system.matrix, system.pinned);
  CycleSolution solution;
  solution.x.assign(mesh.nodes.size(), Vec3::Zero());
  solution.report = multigrid.solve(system.matrix, system.load, solution.x, 1e-9, 0, 200);
  return solution;
}

double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double square = 0, scale = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    square += (a[i] - b[i]).squaredNorm();
    scale += b[i].squaredNorm();
  }
  return std::sqrt(square / scale);
}

TEST(CycleChoices, ComeToTheSameAnswerWithTheSameBitsAtAnyThreadCount) {
  const TetMesh mesh = test_support::make_bar(5);
  for (const double seconds : {0.0, 1.0 / 96}) {
    ElasticParams elastic;
    elastic.seconds = seconds;
    const ElasticSystem system = assemble(mesh, elastic, at_left_end);
    std::vector<Vec3> reference;
    for (const Choice& choice : kChoices) {
      const CycleSolution one = solve(mesh, system, params_of(choice), 1),
                          four = solve(mesh, system, params_of(choice), 4);
      EXPECT_EQ(one.report.status, SolveStatus::Converged) << choice.name;
      EXPECT_FALSE(one.report.double_cycle) << choice.name;
      EXPECT_LE(test_support::relative_residual(system.matrix, system.load, one.x), 1.01e-9) << choice.name;
      EXPECT_EQ(one.report.iterations, four.report.iterations) << choice.name;
      EXPECT_EQ(one.x, four.x) << choice.name;
      if (reference.empty()) reference = one.x;
      EXPECT_LE(distance(one.x, reference), 1e-6) << choice.name;
    }
  }
}

TEST(CycleChoices, ConjugateGradientsNeedFewerIterationsThanTheirCyclesAlone) {
  const TetMesh mesh = test_support::make_bar(5);
  const ElasticSystem system = assemble(mesh, {}, at_left_end);
  for (const SmootherKind smoother :
       {SmootherKind::GaussSeidel, SmootherKind::OneWayGaussSeidel, SmootherKind::Chebyshev}) {
    const int accelerated =
        solve(mesh, system, params_of({"", SolveMethod::ConjugateGradients, smoother}), 1).report.iterations;
    const int alone = solve(mesh, system, params_of({"", SolveMethod::Cycles, smoother}), 1).report.iterations;
    EXPECT_LT(accelerated, alone);
    EXPECT_LE(alone, 8 * accelerated);
  }
}

TEST(CycleChoices, AHigherDegreeTakesFewerIterations) {
  const TetMesh mesh = test_support::make_bar(5);
  const ElasticSystem system = assemble(mesh, {}, at_left_end);
  MultigridParams params;
  params.smoother = SmootherKind::Chebyshev;
  params.chebyshev_degree = 1;
  const int low = solve(mesh, system, params, 1).report.iterations;
  params.chebyshev_degree = 4;
  EXPECT_LT(solve(mesh, system, params, 1).report.iterations, low);
}

TEST(CycleChoices, HoldInTheFloatSolverToo) {
  const TetMesh mesh = test_support::make_bar(5);
  ElasticParams elastic;
  elastic.seconds = 1.0 / 96;
  const ElasticSystem system = assemble(mesh, elastic, at_left_end);
  double norm = 0;
  for (const Vec3& b : system.load) norm += b.squaredNorm();
  norm = std::sqrt(norm);
  for (const Choice& choice : kChoices) {
    std::vector<std::vector<Vec3>> solutions;
    for (const int count : {1, 4}) {
      const Threads threads(count);
      Multigrid multigrid(mesh, {}, system.matrix.pattern, params_of(choice), threads);
      multigrid.update(system.matrix, system.pinned);  // fills the float matrix
      ASSERT_TRUE(multigrid.update_in_float(system.pinned)) << choice.name;
      std::vector<Vec3> y(mesh.nodes.size());
      const FloatCorrection correction = multigrid.correct_in_float(system.load, 1e-4 * norm, 100, y);
      EXPECT_EQ(correction.report.status, SolveStatus::Converged) << choice.name;
      EXPECT_LE(test_support::relative_residual(system.matrix, system.load, y) * norm,
                1e-4 * norm + correction.rounding)
          << choice.name;
      solutions.push_back(y);
    }
    EXPECT_EQ(solutions[0], solutions[1]) << choice.name;
  }
}

}  // namespace
}  // namespace softreel
