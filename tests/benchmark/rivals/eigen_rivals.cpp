// Eigen's own solvers: sparse LDL^T with AMD ordering, conjugate gradients with two preconditioners.
#include <stdexcept>
#include <string>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>

#include "tests/benchmark/rivals/rival.h"

namespace softreel::rivals {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

class EigenLdlt : public Rival {
 public:
  explicit EigenLdlt(const ScalarSystem& system) : system_(system) { solver_.analyzePattern(system.matrix); }
  const char* name() const override { return "eigen_ldlt"; }
  void update() override {
    solver_.factorize(system_.matrix);
    if (solver_.info() != Eigen::Success) throw std::runtime_error("eigen_ldlt: the factorisation failed");
  }
  int solve(double, Eigen::VectorXd& x) override {
    x = solver_.solve(system_.load);
    return 0;
  }

 private:
  const ScalarSystem& system_;
  Eigen::SimplicialLDLT<Matrix> solver_;
};

template <typename Preconditioner>
class EigenCg : public Rival {
 public:
  EigenCg(const ScalarSystem& system, const char* name) : system_(system), name_(name) {
    solver_.analyzePattern(system.matrix);
    solver_.setMaxIterations(100000);
  }
  const char* name() const override { return name_; }
  void update() override { solver_.factorize(system_.matrix); }
  int solve(double tolerance, Eigen::VectorXd& x) override {
    return solve_from(Eigen::VectorXd::Zero(system_.load.size()), tolerance, x);
  }
  int solve_from(const Eigen::VectorXd& guess, double tolerance, Eigen::VectorXd& x) override {
    solver_.setTolerance(tolerance);
    x = solver_.solveWithGuess(system_.load, guess);
    if (solver_.info() != Eigen::Success) throw std::runtime_error(std::string(name_) + ": did not converge");
    return static_cast<int>(solver_.iterations());
  }

 private:
  const ScalarSystem& system_;
  const char* name_;
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper, Preconditioner> solver_;
};

class EigenFactor : public Factor {
 public:
  explicit EigenFactor(const Matrix& matrix) : solver_(matrix) {
    if (solver_.info() != Eigen::Success) throw std::runtime_error("eigen_ldlt: the factorisation failed");
  }
  Eigen::MatrixX3d solve(const Eigen::MatrixX3d& right_sides) const override { return solver_.solve(right_sides); }

 private:
  Eigen::SimplicialLDLT<Matrix> solver_;
};

}  // namespace

std::unique_ptr<Factor> make_eigen_factor(const Eigen::SparseMatrix<double>& matrix) {
  return std::make_unique<EigenFactor>(matrix);
}

std::unique_ptr<Rival> make_eigen_ldlt(const ScalarSystem& system) {
  return std::make_unique<EigenLdlt>(system);
}

std::unique_ptr<Rival> make_eigen_cg_diagonal(const ScalarSystem& system) {
  return std::make_unique<EigenCg<Eigen::DiagonalPreconditioner<double>>>(system, "eigen_cg_diagonal");
}

std::unique_ptr<Rival> make_eigen_cg_ic(const ScalarSystem& system) {
  return std::make_unique<EigenCg<Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::AMDOrdering<int>>>>(
      system, "eigen_cg_ic");
}

}  // namespace softreel::rivals
