// Stands in for cholmod_rival.cpp where CHOLMOD is not installed.
#include <fmt/format.h>

#include "tests/benchmark/rivals/rival.h"

namespace softreel::rivals {

bool has_cholmod() {
  return false;
}

std::unique_ptr<Factor> make_cholmod_factor(const Eigen::SparseMatrix<double>&) {
  return nullptr;
}

std::unique_ptr<Rival> make_cholmod(const ScalarSystem&, int) {
  fmt::print(stderr, "benchmarks: cholmod is left out: it was not found at build time (libsuitesparse-dev)\n");
  return nullptr;
}

}  // namespace softreel::rivals
