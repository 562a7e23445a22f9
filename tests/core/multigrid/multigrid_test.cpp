#include "core/multigrid/multigrid.h"

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "core/elasticity/material.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using test_support::assemble;
using test_support::ElasticParams;
using test_support::ElasticSystem;
using test_support::make_box;

bool at_left_end(const Vec3& x) {
  return x[0] < 1e-9;
}

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

int iterations(const TetMesh& mesh, const ElasticParams& params, double tolerance = 1e-6) {
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
    const Eigen::VectorXd exact = test_support::dense(system.matrix).llt().solve(load);
    double error = 0;
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
      error += (solution.x[i] - exact.segment<3>(3 * static_cast<Index>(i))).squaredNorm();
    EXPECT_LE(std::sqrt(error), 1e-8 * exact.norm());
  }
}

}  // namespace
}  // namespace softreel
