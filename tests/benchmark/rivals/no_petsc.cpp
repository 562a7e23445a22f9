// Stands in for petsc_rival.cpp where PETSc is not installed.
#include <fmt/format.h>

#include "tests/benchmark/rivals/rival.h"

namespace softreel::rivals {

std::unique_ptr<Rival> make_petsc_gamg(const ScalarSystem&) {
  fmt::print(stderr, "solver_rivals: petsc_gamg is left out: it was not found at build time (petsc-dev)\n");
  return nullptr;
}

}  // namespace softreel::rivals
