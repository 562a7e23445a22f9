// Bottom solver and cycle: what conjugate gradients need of a preconditioner.
#include <cstdlib>

#include <gtest/gtest.h>

#include "core/multigrid/gauss_seidel.h"
#include "core/multigrid/v_cycle.h"
#include "tests/core/multigrid/finest_level.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using test_support::assemble;
using test_support::ElasticSystem;
using test_support::Finest;
using test_support::make_box;
using test_support::random_vector;

/// A full matrix of nodes as a level.
BlockMatrixd block_matrix(const Eigen::MatrixXd& dense) {
  BlockMatrixd matrix;
  const auto nodes = static_cast<Index>(dense.rows() / 3);
  matrix.pattern.columns = nodes;
  for (Index i = 0; i < nodes; ++i) {
    for (Index j = 0; j < nodes; ++j) matrix.pattern.column_indices.push_back(j);
    matrix.pattern.row_offsets.push_back(matrix.pattern.blocks());
  }
  reserve_values(matrix);
  for (Index i = 0; i < nodes; ++i)
    for (Index j = 0; j < nodes; ++j)
      for (Index r = 0; r < 3; ++r)
        for (Index c = 0; c < 3; ++c)
          matrix.block(std::int64_t{i} * nodes + j)[3 * c + r] = dense(3 * i + r, 3 * j + c);
  return matrix;
}

TEST(CoarseSolver, SolvesASparseMatrixWithinItsEnvelope) {
  Finest finest;
  CoarseSolver solver(finest.matrix.pattern);
  ASSERT_TRUE(solver.factor(finest.matrix, 1e-15));
  const NodeVector<double> b = random_vector(finest.matrix.pattern.rows(), 4);
  NodeVector<double> x(b.size(), 0), r(b.size(), 0);
  solver.solve(b, x);
  GaussSeidel<double>(finest.hierarchy.levels[0], finest.matrix, SweepDirections::Both)
      .find_residual(b, x, r, Threads(1));
  for (std::size_t k = 0; k < b.size(); ++k) EXPECT_NEAR(k % 4 < 3 ? r[k] : 0, 0, 1e-10);
}

TEST(CoarseSolver, SolvesWhatASemidefiniteMatrixCanSolve) {
  // Rank 8 of 12: a right-hand side in the range must be met. One in 200 of such matrices is refused as indefinite: the
  // first pivots may be small, and none are exchanged.
  std::srand(1);
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(12, 8), A = B * B.transpose();
  CoarseSolver solver(block_matrix(A).pattern);
  ASSERT_TRUE(solver.factor(block_matrix(A), 1e-13));
  const Eigen::VectorXd load = A * Eigen::VectorXd::Random(12);
  NodeVector<double> b(16, 0), x(16, 0);
  for (std::size_t k = 0; k < 12; ++k) b[4 * (k / 3) + k % 3] = load[static_cast<Index>(k)];
  solver.solve(b, x);
  Eigen::VectorXd solution(12);
  for (std::size_t k = 0; k < 12; ++k) solution[static_cast<Index>(k)] = x[4 * (k / 3) + k % 3];
  EXPECT_LE((A * solution - load).norm(), 1e-9 * load.norm());
}

TEST(CoarseSolver, RefusesAnIndefiniteMatrix) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(6, 6);
  A(4, 4) = -1;
  CoarseSolver solver(block_matrix(A).pattern);
  EXPECT_FALSE(solver.factor(block_matrix(A), 1e-15));
  A(4, 4) = std::nan("");
  EXPECT_FALSE(solver.factor(block_matrix(A), 1e-15));
}

/// The cycle as a dense matrix, restricted to nodes that are not pinned.
Eigen::MatrixXd dense_cycle(const TetMesh& mesh, const ElasticSystem& system, const MultigridParams& params) {
  const Threads threads(1);
  const LatticeHierarchy hierarchy = build_lattice_hierarchy(mesh, {}, system.matrix.pattern, params);
  EXPECT_GE(hierarchy.levels.size(), 3u);
  Cycle<double> cycle(hierarchy, params, threads);
  EXPECT_TRUE(cycle.update(system.matrix, system.pinned));
  const auto n = static_cast<Index>(mesh.nodes.size());
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  NodeVector<double> r(static_cast<std::size_t>(4 * n), 0), z = r;
  for (Index k = 0; k < 3 * n; ++k) {
    if (system.pinned[static_cast<std::size_t>(k / 3)]) continue;
    const auto at = static_cast<std::size_t>(4 * (k / 3) + k % 3);
    r[at] = 1;
    cycle.apply(r, 1.0, z);
    r[at] = 0;
    for (Index i = 0; i < n; ++i)
      for (Index c = 0; c < 3; ++c) M(3 * i + c, k) = z[static_cast<std::size_t>(4 * i + c)];
  }
  return M;
}

TEST(Cycle, IsSymmetricAndPositiveAndLeavesPinsAtZero) {
  const TetMesh mesh = make_box({6, 3, 3}, 0.5);
  const ElasticSystem system = assemble(mesh, {}, [](const Vec3& x) { return x[0] < 1e-9; });
  struct CycleChoice {
    CycleKind kind;
    SmootherKind smoother;
    int sweeps;
  };
  const CycleChoice choices[] = {
      {CycleKind::V, SmootherKind::GaussSeidel, 1},       {CycleKind::W, SmootherKind::GaussSeidel, 1},
      {CycleKind::W, SmootherKind::GaussSeidel, 2},       {CycleKind::FullW, SmootherKind::GaussSeidel, 1},
      {CycleKind::FullW, SmootherKind::GaussSeidel, 3},   {CycleKind::FullW, SmootherKind::Chebyshev, 1},
      {CycleKind::V, SmootherKind::OneWayGaussSeidel, 1}, {CycleKind::W, SmootherKind::OneWayGaussSeidel, 1},
      {CycleKind::W, SmootherKind::Chebyshev, 1}};
  for (const auto& [kind, smoother, sweeps] : choices) {
    MultigridParams params;
    params.bottom_nodes = 20;
    params.coarse_cycle = kind;
    params.smoother = smoother;
    params.sweeps = sweeps;
    const Eigen::MatrixXd M = dense_cycle(mesh, system, params);
    EXPECT_LE((M - M.transpose()).norm(), 1e-12 * M.norm());
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
      EXPECT_EQ(M.middleRows<3>(3 * static_cast<Index>(i)).norm() == 0, system.pinned[i] != 0);
    const Eigen::VectorXd eigenvalues = test_support::eigenvalues(M);
    EXPECT_GE(eigenvalues.minCoeff(), -1e-12 * eigenvalues.maxCoeff());
  }
}

}  // namespace
}  // namespace softreel
