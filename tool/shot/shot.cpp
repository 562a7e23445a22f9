#include "tool/shot/shot.h"

#include <fmt/format.h>

namespace softreel {

std::string to_string(const Origin& origin) {
  if (origin.line == 0) return origin.file;
  return fmt::format("{}:{}:{}", origin.file, origin.line, origin.column);
}

SolverParams solver_of(const Shot& shot, const BodySettings& body) {
  SolverParams solver = shot.solver;
  solver.rotation = body.rotation.value_or(solver.rotation);
  return solver;
}

}  // namespace softreel
