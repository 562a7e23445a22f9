/// Other people's solvers behind one interface, to be measured beside softreel's. None of them enters the product.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include "core/base/types.h"
#include "tests/benchmark/bar_problem.h"

namespace softreel::rivals {

/// The system without its pinned nodes, as scalars: nobody pays for rows that say u = 0.
struct ScalarSystem {
  Eigen::SparseMatrix<double> matrix;  ///< both halves, columns compressed
  Eigen::VectorXd load;
  std::vector<Vec3> positions;    ///< rest position of each free node, m: the near-null space of multigrid
  std::vector<Index> mesh_nodes;  ///< mesh node of each free node
};

ScalarSystem make_scalar_system(const benchmark_support::LinearSystem& system, std::span<const Vec3> rest_positions);

/// New values and load of a system with the same pattern and the same pinned nodes as `scalar` was made from.
void take_values(const benchmark_support::LinearSystem& system, ScalarSystem& scalar);

/// One solver on one system. Everything that new values on the same pattern leave as it is, is made in the constructor.
class Rival {
 public:
  virtual ~Rival() = default;
  virtual const char* name() const = 0;
  /// Takes the system's values again: what a time step pays before it can solve.
  virtual void update() = 0;
  /// Solves to |b - A x| <= tolerance |b| from x = 0; returns the iterations, 0 for a direct solver.
  virtual int solve(double tolerance, Eigen::VectorXd& x) = 0;
  /// The same from x = guess; a direct solver needs none.
  virtual int solve_from(const Eigen::VectorXd& guess, double tolerance, Eigen::VectorXd& x);
};

/// All keep the system by reference. Failures throw std::runtime_error.
std::unique_ptr<Rival> make_eigen_ldlt(const ScalarSystem& system);
std::unique_ptr<Rival> make_eigen_cg_diagonal(const ScalarSystem& system);
std::unique_ptr<Rival> make_eigen_cg_ic(const ScalarSystem& system);
/// Null, with a line on stderr, where the library was not found when the benchmark was built.
std::unique_ptr<Rival> make_cholmod(const ScalarSystem& system, int threads);
bool has_cholmod();
std::unique_ptr<Rival> make_petsc_gamg(const ScalarSystem& system);

/// A Cholesky factorisation that is made once and solves for three right sides at once.
class Factor {
 public:
  virtual ~Factor() = default;
  virtual Eigen::MatrixX3d solve(const Eigen::MatrixX3d& right_sides) const = 0;
};

/// Of a symmetric positive definite matrix, both halves given, on one thread. Throws std::runtime_error if it fails.
std::unique_ptr<Factor> make_eigen_factor(const Eigen::SparseMatrix<double>& matrix);
/// Null where the library is missing.
std::unique_ptr<Factor> make_cholmod_factor(const Eigen::SparseMatrix<double>& matrix);

}  // namespace softreel::rivals
