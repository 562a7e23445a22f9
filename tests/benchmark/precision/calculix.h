/// CalculiX (Debian's package calculix-ccx) as a judge: statics of a bar by its program `ccx`.
#pragma once

#include <string>
#include <vector>

#include "tests/benchmark/precision/bar_models.h"

namespace softreel::bench {

/// Whether ccx can be started.
bool has_calculix();

enum class CalculixElement {
  Linear,    ///< C3D4: softreel's own mesh and shape functions
  Quadratic  ///< C3D10 with nodes in the middle of the straight edges
};

enum class CalculixStatics {
  Linear,            ///< small displacements: one solve
  LargeDisplacement  ///< NLGEOM: the whole load at once, cut back by ccx itself where that fails
};

struct CalculixAnswer {
  double seconds = 0;               ///< processor time of the process, its input and output included
  std::vector<Vec3> displacements;  ///< of the watched nodes, m
};

/// Equilibrium of the bar under its model's gravity and `load`, a dead force shared equally by the watched nodes. The
/// material, one for all elements, is linear in Green's strain, so it agrees with a corotated one where strains are
/// small. Throws std::runtime_error with the end of ccx's output if it finds none.
CalculixAnswer solve_by_calculix(const Bar& bar, CalculixElement element, const std::vector<Index>& watched,
                                 const Vec3& load = Vec3::Zero(),
                                 CalculixStatics statics = CalculixStatics::LargeDisplacement);

/// The lines that open the step in ccx's input.
std::string calculix_step(CalculixStatics statics);

}  // namespace softreel::bench
