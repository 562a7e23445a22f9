// CHOLMOD's supernodal Cholesky factorisation, by Eigen's wrapper. Its speed is that of the BLAS behind it.
#include <stdexcept>

#include <Eigen/CholmodSupport>
#include <dlfcn.h>

#include "tests/benchmark/rivals/rival.h"

namespace softreel::rivals {
namespace {

/// OpenBLAS, where it is the BLAS, takes all processors unless it is told; the reference BLAS knows one.
void set_blas_threads(int threads) {
  using SetThreads = void (*)(int);
  if (const auto set = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) set(threads);
}

class Cholmod : public Rival {
 public:
  explicit Cholmod(const ScalarSystem& system) : system_(system) { solver_.analyzePattern(system.matrix); }
  const char* name() const override { return "cholmod"; }
  void update() override {
    solver_.factorize(system_.matrix);
    if (solver_.info() != Eigen::Success) throw std::runtime_error("cholmod: the factorisation failed");
  }
  int solve(double, Eigen::VectorXd& x) override {
    x = solver_.solve(system_.load);
    return 0;
  }

 private:
  const ScalarSystem& system_;
  Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> solver_;
};

class CholmodFactor : public Factor {
 public:
  explicit CholmodFactor(const Eigen::SparseMatrix<double>& matrix) : solver_(matrix) {
    if (solver_.info() != Eigen::Success) throw std::runtime_error("cholmod: the factorisation failed");
  }
  Eigen::MatrixX3d solve(const Eigen::MatrixX3d& right_sides) const override { return solver_.solve(right_sides); }

 private:
  Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace

bool has_cholmod() {
  return true;
}

std::unique_ptr<Factor> make_cholmod_factor(const Eigen::SparseMatrix<double>& matrix) {
  set_blas_threads(1);
  return std::make_unique<CholmodFactor>(matrix);
}

std::unique_ptr<Rival> make_cholmod(const ScalarSystem& system, int threads) {
  set_blas_threads(threads);
  return std::make_unique<Cholmod>(system);
}

}  // namespace softreel::rivals
