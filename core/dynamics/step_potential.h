/// What a time step adds to the potential of statics: with it, the step's force balance is a minimum (design 4.4).
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/sparse/block_matrix.h"

namespace softreel {

/// sum_i weights_i |x_i - centers_i|^2 / 2 + (x - base)^T D (x - base) / 2. The first is inertia and the damping of
/// mass, the second the damping of stiffness with frozen rotations. With the integrator's bases x',
/// v' and seconds t, r of TimeStep its gradient is M a + C v for v = (x - x') / r, a = (v - v') / t.
struct StepPotential {
  std::vector<double> weights;       ///< per node, N/m
  std::vector<Vec3> centers;         ///< per node, m
  std::vector<Vec3> base_positions;  ///< per node, m
  BlockMatrixd damping_stiffness;    ///< D, N/m; no values: nothing of this kind

  bool has_damping_stiffness() const { return !damping_stiffness.values.empty(); }
  /// Energy in J; on the way its forces on the nodes, N.
  double evaluate(std::span<const Vec3> positions, std::span<Vec3> forces, const Threads& threads) const;
  /// About how far rounding may put that energy wrong, J. (x - base)^T D (x - base) is small for a part that moves
  /// rigidly, but a sum of great numbers where the part is stiff.
  double energy_noise(std::span<const Vec3> positions) const;
};

}  // namespace softreel
