// The solve in float that a time step refines.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
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
using test_support::make_box;

SolveReport solve_in_double(const TetMesh& mesh, const ElasticSystem& system, double tolerance) {
  const Threads threads(1);
  Multigrid multigrid(mesh, {}, system.matrix.pattern, {}, threads);
  multigrid.update(system.matrix, system.pinned);
  std::vector<Vec3> x(mesh.nodes.size(), Vec3::Zero());
  return multigrid.solve(system.matrix, system.load, x, tolerance, 0, 400);
}

/// Puts the system's matrix, without its pins, where a caller that assembles in place would.
void fill_float_matrix(Multigrid& multigrid, const BlockMatrixd& matrix) {
  BlockMatrixf& target = multigrid.float_matrix();
  const std::vector<Index>& row = multigrid.row_of_node();
  for (std::size_t i = 0; i < row.size(); ++i)
    for (std::int64_t b = matrix.pattern.row_offsets[i]; b < matrix.pattern.row_offsets[i + 1]; ++b) {
      const auto j = static_cast<std::size_t>(matrix.pattern.column_indices[static_cast<std::size_t>(b)]);
      float* const block = target.block(target.pattern.find(row[i], row[j]));
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) block[3 * c + r] = static_cast<float>(matrix.block(b)[3 * r + c]);
    }
}

TEST(FloatSolver, SolvesInFloatInAsManyIterationsAsInDouble) {
  const TetMesh mesh = make_box({24, 6, 6}, 0.04);
  ElasticParams params;
  params.seconds = 0.01;
  const ElasticSystem system = assemble(mesh, params, at_left_end), free = assemble(mesh, params, {});
  const SolveReport expected = solve_in_double(mesh, system, 1e-4);
  double norm = 0;
  for (const Vec3& b : system.load) norm += b.squaredNorm();
  norm = std::sqrt(norm);
  std::vector<std::vector<Vec3>> solutions;
  for (const int count : {1, 4}) {
    const Threads threads(count);
    Multigrid multigrid(mesh, {}, system.matrix.pattern, {}, threads);
    fill_float_matrix(multigrid, free.matrix);
    ASSERT_TRUE(multigrid.update_in_float(system.pinned));
    std::vector<Vec3> y(mesh.nodes.size());
    const FloatCorrection correction = multigrid.correct_in_float(system.load, 1e-4 * norm, 50, y);
    EXPECT_EQ(correction.report.status, SolveStatus::Converged);
    EXPECT_EQ(correction.report.iterations, expected.iterations);
    const double left = test_support::relative_residual(system.matrix, system.load, y) * norm;
    EXPECT_LE(left, correction.report.residual * norm + correction.rounding);
    EXPECT_GE(left, correction.report.residual * norm - correction.rounding);
    solutions.push_back(y);
  }
  EXPECT_EQ(solutions[0], solutions[1]);
}

/// A system in float, ready to be solved.
struct FloatProblem {
  FloatProblem() : mesh(make_box({24, 6, 6}, 0.04)), threads(2) {
    ElasticParams params;
    params.seconds = 0.01;
    system = assemble(mesh, params, at_left_end);
    multigrid.emplace(mesh, std::span<const double>(), system.matrix.pattern, MultigridParams{}, threads);
    fill_float_matrix(*multigrid, system.matrix);
    EXPECT_TRUE(multigrid->update_in_float(system.pinned));
    for (const Vec3& b : system.load) norm += b.squaredNorm();
    norm = std::sqrt(norm);
  }

  /// The result, which goes to y.
  FloatCorrection solve(double tolerance, std::span<const std::span<const Vec3>> guesses) {
    y.assign(mesh.nodes.size(), Vec3::Zero());
    return multigrid->correct_in_float(system.load, tolerance * norm, 50, y, guesses);
  }

  TetMesh mesh;
  Threads threads;
  ElasticSystem system;
  std::optional<Multigrid> multigrid;
  double norm = 0;
  std::vector<Vec3> y;
};

TEST(FloatSolver, NeedsNoCycleWhereGuessesSpanTheSolution) {
  FloatProblem problem;
  const int plain = problem.solve(1e-6, {}).report.iterations;
  EXPECT_GE(plain, 5);
  const std::vector<Vec3> solution = problem.y;
  std::vector<Vec3> one(solution.size()), other(solution.size());
  for (std::size_t i = 0; i < solution.size(); ++i) {
    const double share = 0.5 + 0.5 * std::sin(20 * problem.mesh.nodes[i].x());
    one[i] = -3e5 * share * solution[i];  // a direction: neither its sign nor its length matters
    other[i] = (1 - share) * solution[i];
  }
  const std::span<const Vec3> whole[] = {solution}, halves[] = {one, other};
  for (const auto guesses :
       {std::span<const std::span<const Vec3>>(whole), std::span<const std::span<const Vec3>>(halves)}) {
    const FloatCorrection found = problem.solve(1e-4, guesses);
    EXPECT_EQ(found.report.status, SolveStatus::Converged);
    EXPECT_EQ(found.report.iterations, 0);
    EXPECT_LE(test_support::relative_residual(problem.system.matrix, problem.system.load, problem.y),
              1e-4 + found.rounding / problem.norm);
  }
}

TEST(FloatSolver, IsNotMisledByGuesses) {
  FloatProblem problem;
  const int plain = problem.solve(1e-6, {}).report.iterations;
  const std::vector<Vec3> expected = problem.y, zero(expected.size(), Vec3::Zero());
  std::vector<Vec3> rough(expected.size()), broken = expected;
  for (std::size_t i = 0; i < rough.size(); ++i)
    rough[i] = problem.system.pinned[i] != 0 ? Vec3(Vec3::Zero()) : Vec3(i % 2 == 0 ? 1 : -1, i % 3, i % 5);
  broken.back()[0] = std::numeric_limits<double>::infinity();
  const std::span<const Vec3> useless[] = {zero, broken, {}}, bad[] = {rough, rough};
  EXPECT_EQ(problem.solve(1e-6, useless).report.iterations, plain);
  EXPECT_EQ(problem.y, expected);
  const FloatCorrection found = problem.solve(1e-6, bad);
  EXPECT_EQ(found.report.status, SolveStatus::Converged);
  EXPECT_LE(found.report.iterations, plain + 1);
}

TEST(FloatSolver, RefusesInFloatWhatIsNotDefinite) {
  const TetMesh mesh = make_box({12, 3, 3}, 0.1);
  const ElasticSystem system = assemble(mesh, {}, at_left_end);
  const Threads threads(1);
  Multigrid multigrid(mesh, {}, system.matrix.pattern, {}, threads);
  fill_float_matrix(multigrid, system.matrix);
  const auto node =
      static_cast<std::size_t>(std::find(system.pinned.begin(), system.pinned.end(), 0) - system.pinned.begin());
  const Index row = multigrid.row_of_node()[node];
  BlockMatrixf& matrix = multigrid.float_matrix();
  float& entry = matrix.block(matrix.pattern.find(row, row))[4];
  EXPECT_TRUE(multigrid.update_in_float(system.pinned));
  for (const float bad : {-entry, std::numeric_limits<float>::quiet_NaN()}) {
    entry = bad;
    EXPECT_FALSE(multigrid.update_in_float(system.pinned));
  }
}

}  // namespace
}  // namespace softreel
